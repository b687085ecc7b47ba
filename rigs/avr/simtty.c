/* The pseudo terminal, and what it shares with a real USB serial chip.
 *
 * Rule 1: nobody keeps the client's end open for it. So opening and closing are seen (POLLHUP), and
 *         what is sent without a client is lost, as on a real chip.
 * Rule 2: nothing here waits, but tty_wait.
 * Rule 3: the client's baud rate is asked of the kernel (TCGETS2), so a wrong one is noticed.
 */
#define _GNU_SOURCE
#include <asm/termbits.h> /* not <termios.h>: only this one knows every baud rate */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include "simtty.h"

/* No echo, no line editing, 8 bits, before the first client comes. */
static int make_raw(const char *name) {
    int slave = open(name, O_RDWR | O_NOCTTY | O_CLOEXEC);
    struct termios2 settings;
    if (slave < 0)
        return -1;
    int failed = ioctl(slave, TCGETS2, &settings);
    settings.c_iflag = settings.c_oflag = settings.c_lflag = 0;
    settings.c_cflag = (settings.c_cflag & ~(CSIZE | PARENB)) | CS8 | CREAD | CLOCAL | HUPCL;
    failed = failed || ioctl(slave, TCSETS2, &settings);
    close(slave);
    return failed ? -1 : 0;
}

int tty_plug(tty_t *tty, const char *link) {
    tty->link = link;
    tty->master = posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
    if (tty->master < 0 || grantpt(tty->master) || unlockpt(tty->master))
        return -1;
    const char *name = ptsname(tty->master);
    if (!name || make_raw(name))
        return -1;
    unlink(link);
    return symlink(name, link);
}

void tty_unplug(tty_t *tty) {
    if (tty->master < 0)
        return;
    unlink(tty->link);
    close(tty->master);
    tty->master = -1;
}

static int ready(const tty_t *tty, short events, int timeout_ms) {
    struct pollfd pollfd = {tty->master, events, 0};
    return poll(&pollfd, 1, timeout_ms) > 0 ? pollfd.revents : 0;
}

int tty_has_client(const tty_t *tty) {
    return tty->master >= 0 && !(ready(tty, 0, 0) & POLLHUP);
}

int tty_hangs_up(const tty_t *tty) {
    struct termios2 settings;
    return tty->master < 0 || ioctl(tty->master, TCGETS2, &settings) || settings.c_cflag & HUPCL;
}

unsigned tty_baud(const tty_t *tty) {
    struct termios2 settings;
    if (tty->master < 0 || ioctl(tty->master, TCGETS2, &settings))
        return 0;
    return settings.c_ospeed;
}

size_t tty_read(const tty_t *tty, uint8_t *bytes, size_t room) {
    if (tty->master < 0 || !room)
        return 0;
    ssize_t count = read(tty->master, bytes, room);
    return count > 0 ? (size_t)count : 0;
}

void tty_write(tty_t *tty, const uint8_t *bytes, size_t count) {
    ssize_t written = tty_has_client(tty) ? write(tty->master, bytes, count) : 0;
    tty->dropped += count - (written > 0 ? (size_t)written : 0);
}

int tty_wait(const tty_t *tty, int timeout_ms) {
    return tty->master >= 0 && (ready(tty, POLLIN, timeout_ms) & POLLIN);
}
