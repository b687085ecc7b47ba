/* The C side: one line a call to "python -m fraese.x4step.server", one line back.
   The end of this program, however it comes, is the end of the line: the server brakes and
   switches all off. */
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "conio.h"
#include "dos.h"
#include "x4step.h"

#ifndef X4STEP_PYTHON
#define X4STEP_PYTHON "python3"
#endif

static FILE *answers;
static int line_fd = -1;

static void begin(void)
{
    const char *python = getenv("X4STEP_PYTHON");
    char number[16];
    int ends[2];

    if (python == NULL)
        python = X4STEP_PYTHON;
    fflush(NULL);
    if (socketpair(AF_UNIX, SOCK_STREAM, 0, ends) != 0) {
        perror("x4step");
        exit(1);
    }
    sprintf(number, "%d", ends[1]);
    if (fork() == 0) {
        close(ends[0]);
        execlp(python, python, "-m", "fraese.x4step.server", number, (char *)NULL);
        perror(python);
        _exit(127);
    }
    close(ends[1]);
    fcntl(ends[0], F_SETFD, FD_CLOEXEC);
    line_fd = ends[0];
    answers = fdopen(line_fd, "r");
}

static long call(const char *text)
{
    char answer[64];

    if (line_fd < 0)
        begin();
    fflush(stdout);
    if (send(line_fd, text, strlen(text), MSG_NOSIGNAL) < 0 ||
        fgets(answer, sizeof answer, answers) == NULL) {
        fprintf(stderr, "x4step: fraese has ended\n");
        exit(1);
    }
    return atol(answer);
}

static long call3(const char *name, long a, long b, long c)
{
    char text[128];

    sprintf(text, "%s %ld %ld %ld\n", name, a, b, c);
    return call(text);
}

static long call1(const char *name, long a)
{
    char text[64];

    sprintf(text, "%s %ld\n", name, a);
    return call(text);
}

int X4Load(long weg1, long weg2, long weg3, long weg4, int freq, int ramp)
{
    char text[192];

    sprintf(text, "X4Load %ld %ld %ld %ld %d %d\n", weg1, weg2, weg3, weg4, freq, ramp);
    return (int)call(text);
}

/* As many codes as there are, up to the 0; of far too many, enough to be refused. */
int X4BrakeCodes(char *codes)
{
    char text[512] = "X4BrakeCodes";
    int n;

    for (n = 0; codes[n] != 0 && n < 64; ++n)
        sprintf(text + strlen(text), " %d", (unsigned char)codes[n]);
    strcat(text, "\n");
    return (int)call(text);
}

int X4Init(int lpt) { return (int)call1("X4Init", lpt); }
int X4ReInit(void) { return (int)call("X4ReInit\n"); }
int X4Start(void) { return (int)call("X4Start\n"); }
int X4Brake(void) { return (int)call("X4Brake\n"); }
int X4Stop(void) { return (int)call("X4Stop\n"); }
int X4GetState(void) { return (int)call("X4GetState\n"); }
long X4GetSteps(int achse) { return call1("X4GetSteps", achse); }
int X4MovePos(int achse, int freq, int ramp) { return (int)call3("X4MovePos", achse, freq, ramp); }
int X4MoveNeg(int achse, int freq, int ramp) { return (int)call3("X4MoveNeg", achse, freq, ramp); }
int X4LastBrakeCode(void) { return (int)call("X4LastBrakeCode\n"); }
void X4ClearTimer(void) { call("X4ClearTimer\n"); }
long X4GetTimer(void) { return call("X4GetTimer\n"); }
int X4GetIn(void) { return (int)call("X4GetIn\n"); }
int X4SetOut(int sig) { return (int)call1("X4SetOut", sig); }

int getch(void) { return (int)call("getch\n"); }
int kbhit(void) { return (int)call("kbhit\n"); }
int inp(unsigned port) { return port == 0x60 ? (int)call("last_scan_code\n") : 0xFF; }

void delay(unsigned ms)
{
    call1("delay", (long)ms);
}
