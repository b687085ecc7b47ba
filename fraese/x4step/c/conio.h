/* What programs of X4Step want of DOS's conio.h. */
#ifndef X4STEP_CONIO_H
#define X4STEP_CONIO_H

/* The next key: a character; for arrows and such 0, and then the make code. -1: there is none. */
int getch(void);
/* A key waits. */
int kbhit(void);

#endif
