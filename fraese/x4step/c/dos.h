/* What programs of X4Step want of DOS's dos.h. */
#ifndef X4STEP_DOS_H
#define X4STEP_DOS_H

/* Port 60h is the keyboard's: the last scan code. There are no other ports. */
int inp(unsigned port);
#define inportb inp
/* Wait so many milliseconds. */
void delay(unsigned ms);

#endif
