/* A pseudo terminal that stands for the USB serial chip of an Arduino. */
#ifndef SIMTTY_H
#define SIMTTY_H

#include <stddef.h>
#include <stdint.h>

typedef struct {
    int master; /* -1: unplugged */
    const char *link;
    uint64_t dropped; /* bytes nobody took */
} tty_t;

/* Opens a pty and makes `link` point to it. Answers 0, or -1 with errno set. */
int tty_plug(tty_t *tty, const char *link);
/* The client reads an end of file, and the link is gone. */
void tty_unplug(tty_t *tty);
int tty_has_client(const tty_t *tty);
/* Whether DTR falls when the client closes the port, as far as it has set that (HUPCL). */
int tty_hangs_up(const tty_t *tty);
/* The baud rate the client has set; 0 without a client. */
unsigned tty_baud(const tty_t *tty);
size_t tty_read(const tty_t *tty, uint8_t *bytes, size_t room);
void tty_write(tty_t *tty, const uint8_t *bytes, size_t count);
/* Waits until the client has sent something; 0 when it has not within the time. */
int tty_wait(const tty_t *tty, int timeout_ms);

#endif
