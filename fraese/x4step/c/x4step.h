/* X4Step for C programs on Linux: the sixteen functions of the library X4Step 1.0 (B. Lewetz, 1995).
   The steps are made by fraese, which is started at the first call and goes with the program.
   Compile with: gcc prog.c $(fraese x4step --cflags --libs) */
#ifndef X4STEP_H
#define X4STEP_H

#define LPT1 1
#define LPT2 2
#define LPT3 3
#define LPT4 4

#define SIGNAL1ON 1
#define SIGNAL1OFF 2
#define SIGNAL2ON 3
#define SIGNAL2OFF 4

#define X4NoErr 0
#define X4ErrNoSteps 1
#define X4ErrFreqTooHigh 2
#define X4ErrFreqTooLow 3
#define X4ErrRampTooHigh 4
#define X4ErrRampFreq 5
#define X4ErrLPTNotFound 6
#define X4ErrNotActive 7
#define X4ErrParamFail 8
#define X4ErrInitNotDone 9
#define X4ErrIsActive 10
#define X4ErrNotLoaded 11
#define X4ErrIsLoaded 12
#define X4ErrStepsTooHigh 13

#ifdef __cplusplus
extern "C" {
#endif

int X4Init(int lpt);
int X4ReInit(void);
int X4Load(long weg1, long weg2, long weg3, long weg4, int freq, int ramp);
int X4Start(void);
int X4Brake(void);
int X4Stop(void);
int X4GetState(void);
long X4GetSteps(int achse);
int X4MovePos(int achse, int freq, int ramp);
int X4MoveNeg(int achse, int freq, int ramp);
int X4BrakeCodes(char *codes);
int X4LastBrakeCode(void);
void X4ClearTimer(void);
long X4GetTimer(void);
int X4GetIn(void);
int X4SetOut(int sig);

#ifdef __cplusplus
}
#endif

#endif
