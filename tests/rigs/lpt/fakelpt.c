/* A fake parallel port in front of libc.
 *
 *     process --open, ioctl, pread, pwrite--> fakelpt.so --anything else--> libc
 *                                                |
 *                          bench file, mapped by everybody: lines and log
 *
 * Preloaded, it answers for /dev/parport0 (ppdev) and /dev/port as a Linux kernel with one port at
 * 0x378 does, under an unmodified Python or QEMU:
 *
 *     gcc -shared -fPIC -O2 -o fakelpt.so fakelpt.c
 *     FAKELPT=bench.bin LD_PRELOAD=./fakelpt.so python3 ...
 *
 * Rule 1: everything a test sets or sees lies in the bench file, mapped shared: the test may change
 *         it at any time, and what was logged survives any death of the process.
 * Rule 2: every fake descriptor is the bench file, opened anew, and a registration is a flock() on
 *         it: exclusive after PPEXCL, else shared. So it ends where the kernel's ends: with the last
 *         close, also that of a killed process. A record lock on /dev/port is a true one, too.
 * Rule 3: what the kernel does to the registers by itself is done and logged here too: a claim puts
 *         control to rest, twice; bit 4 of it is the kernel's; release and close write nothing.
 * Rule 4: there may be carriages on the port. They follow every step, at once, however fast it comes,
 *         and hold the switch line closed at their ends and beyond. Between processes they stand.
 * Rule 5: the switch may be a bad one (enum fault), and the clock of the day may be set while a
 *         process runs: both only for processes that have this library.
 *
 * Not modelled: two owners of a shared port taking turns, interrupts, and time on the bus.
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/ppdev.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

#define BASE 0x378
#define KERNEL_BITS 0x10 /* of control: the kernel's interrupt bit */
#define CARD_BITS 0x0f   /* of control: what ppdev lets through */
#define CLAIMED 0x0c     /* control after a claim: DB25 pins 1, 14 and 16 high, 17 low */
#define CONTACT 0x80     /* of status: reads 0 with contact */
#define STROBE 0x01      /* of control: setting it latches a byte of the phase-current card */
#define MOTORS 3
#define MAX_FD 4096

enum { DATA, STATUS, CONTROL, REGISTERS };
#define FAULT 3 /* of lines */

/* Where the test may put an errno, so that the call is refused. */
enum { REFUSE_OPEN_PARPORT, REFUSE_OPEN_PORT, REFUSE_EXCL, REFUSE_CLAIM, REFUSE_ACCESS, REFUSALS };

struct event {
  uint64_t at_ns; /* CLOCK_MONOTONIC */
  uint32_t pid;
  uint8_t what; /* O open, E exclusive, C claim, L release, X close, R read, W write, ? other ioctl */
  uint8_t reg;
  uint8_t value;
  uint8_t unused;
};

enum wiring { NO_CARRIAGES, PHASE_CARD, STEP_DIRECTION };

struct carriage {
  volatile int32_t at_steps; /* from the switch at its lower end; begins in the middle */
  int32_t travel_steps;
};

/* What is wrong with the switch of the carriages. */
enum fault {
  SOUND,
  GLITCHES, /* the next reading is wrong, and then it is SOUND */
  BOUNCES,  /* after each change some readings are one way and the other */
  STICKS,   /* once closed, it stays so */
  LATE,     /* once closed, it opens only LATE_STEPS further */
};
#define CLOSED_BEFORE 0x80 /* added to STICKS and LATE */
#define BOUNCING 12        /* readings */
#define LATE_STEPS 60

struct bench {
  /* The registers as they stand; the test drives [STATUS]. The fourth is the switch's fault. */
  volatile uint8_t lines[4];
  volatile int32_t refuse[REFUSALS];
  uint32_t capacity;       /* events that the file has room for */
  uint32_t wiring;         /* of the carriages */
  volatile uint64_t count; /* events, also those that found no room */
  struct carriage carriages[MOTORS];
  volatile int64_t set_s; /* how far the clock of the day was set */
  struct event events[];
};

_Static_assert(sizeof(struct event) == 16 && sizeof(struct bench) == 72, "see fakeport.py");

enum kind { NONE, PARPORT, PORT };

static struct {
  uint8_t kind, exclusive, claimed;
} files[MAX_FD];

static struct bench *bench;
static int (*libc_open)(const char *, int, ...);
static int (*libc_close)(int);
static int (*libc_ioctl)(int, unsigned long, ...);
static ssize_t (*libc_pread)(int, void *, size_t, off_t);
static ssize_t (*libc_pwrite)(int, const void *, size_t, off_t);
static int (*libc_gettime)(clockid_t, struct timespec *);

/* At the latest with the first call: a forked process may be told its bench later. */
__attribute__((constructor)) static void start(void) {
  if (bench) return;
  libc_close = dlsym(RTLD_NEXT, "close");
  libc_ioctl = dlsym(RTLD_NEXT, "ioctl");
  libc_pread = dlsym(RTLD_NEXT, "pread64");
  libc_pwrite = dlsym(RTLD_NEXT, "pwrite64");
  libc_gettime = dlsym(RTLD_NEXT, "clock_gettime");
  libc_open = dlsym(RTLD_NEXT, "open64");
  const char *path = getenv("FAKELPT");
  int fd = path ? libc_open(path, O_RDWR | O_CLOEXEC) : -1;
  if (fd < 0) return;
  off_t size = lseek(fd, 0, SEEK_END);
  void *map = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  if (map != MAP_FAILED) bench = map;
  libc_close(fd);
}

static void note(char what, int reg, int value) {
  uint64_t place = __atomic_fetch_add(&bench->count, 1, __ATOMIC_RELAXED);
  if (place >= bench->capacity) return;
  struct timespec now;
  libc_gettime(CLOCK_MONOTONIC, &now);
  struct event *event = &bench->events[place];
  event->at_ns = now.tv_sec * 1000000000ull + now.tv_nsec;
  event->pid = getpid();
  event->reg = reg;
  event->value = value;
  event->what = what;
}

static int refused(int which) {
  if (!bench->refuse[which]) return 0;
  errno = bench->refuse[which];
  return 1;
}

/* --- carriages ------------------------------------------------------------------------------- */

/* A phase byte in the order of the drive table, a half-step each; -1: no current, no torque. */
static int phase_of(int byte) {
  static const uint8_t table[] = {0x03, 0x09, 0x38, 0x29, 0x27, 0x2d, 0x1c, 0x0d};
  for (int phase = 0; phase < 8; phase++)
    if (table[phase] == (byte & 0x3f)) return phase;
  return -1;
}

/* A rotor turns the shorter way to the phase. In the middle of its travel it stands at phase 0. */
static void latch(int byte) {
  int motor = byte >> 6, phase = phase_of(byte);
  if (motor >= MOTORS || phase < 0) return;
  struct carriage *carriage = &bench->carriages[motor];
  int turned = (phase - (carriage->at_steps - carriage->travel_steps / 2)) & 7;
  carriage->at_steps += turned > 4 ? turned - 8 : turned;
}

/* Data bits 2k and 2k+1 are direction (high is forward) and clock of motor k. */
static void clock_edges(int before, int after) {
  for (int motor = 0; motor < MOTORS; motor++)
    if (~before & after & 2 << 2 * motor)
      bench->carriages[motor].at_steps += after & 1 << 2 * motor ? 1 : -1;
}

static void drive(long reg, int value) {
  if (bench->wiring == PHASE_CARD && reg == CONTROL && ~bench->lines[CONTROL] & value & STROBE)
    latch(bench->lines[DATA]);
  if (bench->wiring == STEP_DIRECTION && reg == DATA) clock_edges(bench->lines[DATA], value);
}

static int is_within(int steps) {
  for (int motor = 0; bench->wiring && motor < MOTORS; motor++) {
    struct carriage *carriage = &bench->carriages[motor];
    int at = carriage->at_steps;
    if (at <= steps || at >= carriage->travel_steps - steps) return 1;
  }
  return 0;
}

static int bounced(int closed) {
  static int before, left;
  if (closed != before) left = BOUNCING;
  before = closed;
  return left > 0 && (left-- * 5 & 2) ? !closed : closed;
}

/* One reading of the switch. */
static int is_at_an_end(void) {
  int closed = is_within(0), fault = bench->lines[FAULT];
  switch (fault & ~CLOSED_BEFORE) {
  case GLITCHES: bench->lines[FAULT] = SOUND; return !closed;
  case BOUNCES: return bounced(closed);
  case STICKS: closed |= fault & CLOSED_BEFORE; break;
  case LATE: closed |= fault & CLOSED_BEFORE && is_within(LATE_STEPS); break;
  default: return closed;
  }
  bench->lines[FAULT] = (fault & ~CLOSED_BEFORE) | (closed ? CLOSED_BEFORE : 0);
  return closed;
}

/* --- registers ------------------------------------------------------------------------------- */

/* Registers 0 to 2 are lines; others of the block exist, and do nothing. */
static void write_register(long reg, int value) {
  drive(reg, value);
  if (reg == DATA || reg == CONTROL) bench->lines[reg] = value;
  note('W', reg, value);
}

static int read_register(long reg) {
  int value = reg >= DATA && reg < REGISTERS ? bench->lines[reg] : 0xff;
  if (reg == STATUS && is_at_an_end()) value &= ~CONTACT;
  note('R', reg, value);
  return value;
}

/* The kernel: what ppdev writes to control has the interrupt bit set. */
static void write_control(int value) { write_register(CONTROL, (value & CARD_BITS) | KERNEL_BITS); }

/* --- open and close ------------------------------------------------------------------------- */

static enum kind kind_of_path(const char *path) {
  if (!bench || !path) return NONE;
  return !strcmp(path, "/dev/parport0") ? PARPORT : !strcmp(path, "/dev/port") ? PORT : NONE;
}

static enum kind kind_of(int fd) { return fd >= 0 && fd < MAX_FD ? files[fd].kind : NONE; }

static int do_open(const char *path, int flags, mode_t mode) {
  start();
  enum kind kind = kind_of_path(path);
  if (kind == NONE) return libc_open(path, flags, mode);
  if (refused(kind == PARPORT ? REFUSE_OPEN_PARPORT : REFUSE_OPEN_PORT)) return -1;
  int fd = libc_open(getenv("FAKELPT"), O_RDWR | (flags & O_CLOEXEC));
  if (fd < 0) return fd;
  if (fd >= MAX_FD) {
    libc_close(fd);
    errno = EMFILE;
    return -1;
  }
  memset(&files[fd], 0, sizeof files[fd]);
  files[fd].kind = kind;
  note('O', 0, kind);
  return fd;
}

#define OPEN(name)                                                                                 \
  int name(const char *path, int flags, ...) {                                                     \
    va_list rest;                                                                                  \
    va_start(rest, flags);                                                                         \
    mode_t mode = flags & (O_CREAT | O_TMPFILE) ? va_arg(rest, mode_t) : 0;                        \
    va_end(rest);                                                                                  \
    return do_open(path, flags, mode);                                                             \
  }
OPEN(open)
OPEN(open64)

int close(int fd) {
  start();
  if (kind_of(fd) != NONE) {
    note('X', 0, files[fd].kind);
    files[fd].kind = NONE;
  }
  return libc_close(fd);
}

/* --- the clock of the day ------------------------------------------------------------------- */

int clock_gettime(clockid_t clock, struct timespec *now) {
  start();
  int failed = libc_gettime(clock, now);
  if (!failed && bench && clock == CLOCK_REALTIME) now->tv_sec += bench->set_s;
  return failed;
}

/* --- /dev/parport0 -------------------------------------------------------------------------- */

/* Registered with the port at the first claim, until the last close: alone, or among others. */
static int claim(int fd) {
  if (files[fd].claimed) {
    errno = EINVAL;
    return -1;
  }
  if (refused(REFUSE_CLAIM)) return -1;
  if (flock(fd, (files[fd].exclusive ? LOCK_EX : LOCK_SH) | LOCK_NB)) {
    errno = ENXIO;
    return -1;
  }
  write_control(CLAIMED);
  write_control(CLAIMED);
  files[fd].claimed = 1;
  note('C', 0, 0);
  return 0;
}

static int make_exclusive(int fd) {
  if (refused(REFUSE_EXCL)) return -1;
  files[fd].exclusive = 1;
  note('E', 0, 0);
  return 0;
}

static int access_port(int fd, unsigned request, void *argument) {
  uint8_t *byte = argument;
  switch (request) {
  case PPRELEASE: files[fd].claimed = 0; note('L', 0, 0); return 0;
  case PPWDATA: write_register(DATA, *byte); return 0;
  case PPWCONTROL: write_control(*byte); return 0;
  case PPFCONTROL: write_control((bench->lines[CONTROL] & ~byte[0]) ^ byte[1]); return 0;
  case PPRDATA: *byte = read_register(DATA); return 0;
  case PPRSTATUS: *byte = read_register(STATUS); return 0;
  case PPRCONTROL: *byte = read_register(CONTROL) & CARD_BITS; return 0;
  case PPDATADIR:
  case PPNEGOT:
  case PPSETMODE: note('?', request & 0xff, 0); return 0;
  }
  errno = ENOTTY;
  return -1;
}

int ioctl(int fd, unsigned long request, ...) {
  va_list rest;
  va_start(rest, request);
  void *argument = va_arg(rest, void *);
  va_end(rest);
  start();
  if (kind_of(fd) != PARPORT) return libc_ioctl(fd, request, argument);
  /* Callers hand the request over sign-extended or not: 32 bits of it count. */
  switch ((unsigned)request) {
  case PPEXCL: return make_exclusive(fd);
  case PPCLAIM: return claim(fd);
  case PPGETMODES: *(int *)argument = 0; return 0;
  }
  if (!files[fd].claimed) {
    errno = EINVAL;
    return -1;
  }
  if (refused(REFUSE_ACCESS)) return -1;
  return access_port(fd, request, argument);
}

/* --- /dev/port: consecutive bytes are consecutive registers --------------------------------- */

ssize_t pwrite64(int fd, const void *bytes, size_t size, off_t offset) {
  start();
  if (kind_of(fd) != PORT) return libc_pwrite(fd, bytes, size, offset);
  if (refused(REFUSE_ACCESS)) return -1;
  for (size_t i = 0; i < size; i++)
    write_register(offset + i - BASE, ((const uint8_t *)bytes)[i]);
  return size;
}

ssize_t pread64(int fd, void *bytes, size_t size, off_t offset) {
  start();
  if (kind_of(fd) != PORT) return libc_pread(fd, bytes, size, offset);
  if (refused(REFUSE_ACCESS)) return -1;
  for (size_t i = 0; i < size; i++) ((uint8_t *)bytes)[i] = read_register(offset + i - BASE);
  return size;
}
