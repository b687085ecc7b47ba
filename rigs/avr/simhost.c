/* simhost: the simulated microcontroller behind a pty, for pyserial and the whole program.
 *
 *   simhost IMAGE --link PATH [options]        simoptions.h has the list
 *
 *   SIGTERM, SIGINT: ends, link removed, exit code 0.   SIGUSR1: unplug.   SIGUSR2: plug in again.
 *
 * Rule 1: simulated time never runs after the wall clock: what was lost is lost (CATCH_UP_S). A
 *         busy machine makes the AVR slow, never the host late.
 * Rule 2: an unplugged AVR runs on.
 *
 *   slice   |--run--|pty|log|sleep...|--run--|pty|log|sleep...|      100 us of simulated time each
 */
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "simcore.h"
#include "simoptions.h"
#include "simtty.h"

#define SLICE_CYCLES (SIM_F_CPU_HZ / 10000)
#define CATCH_UP_S 0.002
#define USB_BUFFER_BYTES 64 /* what the serial chip holds; the rest waits in the kernel */
#define SHARED_BYTES 40

/* Written by others while we run; cycle, client and marked are ours. */
struct shared {
    uint8_t driven[3]; /* pins of ports B, C, D that are driven from outside */
    uint8_t level[3];  /* their levels */
    uint8_t hold;      /* simulated time stands still while this is not 0 */
    uint8_t client;    /* somebody has the serial port open */
    uint64_t cycle;
    uint64_t marked_cycle; /* when the marked byte came; written if it was 0, as others make it */
    uint64_t marked_ns;    /* the same by the wall (CLOCK_MONOTONIC) */
    uint64_t limit_cycle;  /* simulated time waits here until it is moved on; 0: nowhere */
};

struct host {
    options_t options;
    sim_t *sim;
    tty_t tty;
    int log;
    volatile struct shared *shared;
    uint8_t driven[3], level[3];
    int had_client, dtr, owed, stalls;
    uint64_t boot_until_cycle;
    double wall_start_s; /* when simulated time was 0, moved on when time was lost */
};

static volatile sig_atomic_t wants_end, wants_unplug, wants_plug;

static void on_signal(int number) {
    if (number == SIGUSR1)
        wants_unplug = 1;
    else if (number == SIGUSR2)
        wants_plug = 1;
    else
        wants_end = 1;
}

static double wall_s(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}

static double simulated_s(const struct host *host) {
    return (double)sim_cycle(host->sim) / SIM_F_CPU_HZ;
}

/* ---- what happens after each slice ---- */

static void follow_shared(struct host *host) {
    volatile struct shared *shared = host->shared;
    for (int port = 0; port < 3; port++)
        for (int pin = 0; pin < 8; pin++) {
            int is_driven = shared->driven[port] >> pin & 1, level = shared->level[port] >> pin & 1;
            int was_driven = host->driven[port] >> pin & 1, was = host->level[port] >> pin & 1;
            if (is_driven && (!was_driven || level != was))
                sim_set_pin(host->sim, (char)('B' + port), pin, level);
        }
    memcpy(host->driven, (const void *)shared->driven, 3);
    memcpy(host->level, (const void *)shared->level, 3);
    shared->cycle = sim_cycle(host->sim);
    shared->client = (uint8_t)host->had_client;
}

/* A client that opens the port pulls DTR, which resets an Arduino, unless the last one left it so. */
static void follow_client(struct host *host) {
    int has_client = tty_has_client(&host->tty);
    if (!has_client && host->had_client)
        host->dtr = !tty_hangs_up(&host->tty);
    if (has_client && !host->had_client && !host->dtr && !host->options.keep_running) {
        sim_drop_backlog(host->sim);
        sim_reset(host->sim);
        host->boot_until_cycle =
            sim_cycle(host->sim) + (uint64_t)host->options.boot_ms * (SIM_F_CPU_HZ / 1000);
    }
    host->had_client = has_client;
    unsigned baud = has_client && !host->options.any_baud ? tty_baud(&host->tty) : 0;
    sim_host_bit_cycles(host->sim, baud ? (double)SIM_F_CPU_HZ / baud : 0);
}

static void mark(struct host *host, const uint8_t *bytes, size_t count) {
    if (!host->options.mark || host->shared->marked_cycle || !memchr(bytes, host->options.mark, count))
        return;
    host->shared->marked_ns = (uint64_t)(wall_s() * 1e9);
    host->shared->marked_cycle = sim_cycle(host->sim);
}

static void carry_bytes(struct host *host) {
    uint8_t bytes[USB_BUFFER_BYTES];
    sim_event_t sent[USB_BUFFER_BYTES];
    size_t backlog = sim_backlog(host->sim);
    size_t room = backlog < sizeof bytes ? sizeof bytes - backlog : 0;
    size_t count = tty_read(&host->tty, bytes, room);
    mark(host, bytes, count);
    if (sim_cycle(host->sim) >= host->boot_until_cycle)
        sim_feed(host->sim, bytes, count, 0, 0);
    while ((count = sim_take(host->sim, sent, USB_BUFFER_BYTES))) {
        for (size_t i = 0; i < count; i++)
            bytes[i] = sent[i].value;
        tty_write(&host->tty, bytes, count);
        host->owed = 1;
    }
}

static int write_log(struct host *host) {
    const sim_event_t *events;
    size_t bytes = sim_log(host->sim, &events) * sizeof *events;
    for (size_t done = 0; host->log >= 0 && done < bytes;) {
        ssize_t count = write(host->log, (const char *)events + done, bytes - done);
        if (count < 0 && errno != EINTR)
            return complain("the log cannot be written: ", strerror(errno));
        done += count > 0 ? (size_t)count : 0;
    }
    sim_clear_log(host->sim);
    return 0;
}

static void plug_as_wanted(struct host *host) {
    double after_s = host->options.unplug_after_s;
    if (wants_unplug || (after_s > 0 && simulated_s(host) >= after_s)) {
        host->options.unplug_after_s = 0;
        tty_unplug(&host->tty);
    }
    if (wants_plug && host->tty.master < 0)
        tty_plug(&host->tty, host->options.link);
    wants_unplug = wants_plug = 0;
}

/* ---- time ---- */

/* The AVR has spoken and hears nothing: the host's answer may be on its way. */
static void wait_for_host(struct host *host) {
    if (!host->options.stall_ms || !host->owed || sim_backlog(host->sim) || !host->had_client)
        return;
    if (!tty_wait(&host->tty, host->options.stall_ms)) {
        host->stalls++;
        host->owed = 0; /* it has nothing to say: do not wait again before the AVR speaks */
    }
}

static void sleep_s(double seconds) {
    struct timespec time = {(time_t)seconds, (long)((seconds - (double)(time_t)seconds) * 1e9)};
    nanosleep(&time, NULL);
}

static int must_wait(const struct host *host) {
    uint64_t limit_cycle = host->shared->limit_cycle;
    return host->shared->hold || (limit_cycle && sim_cycle(host->sim) >= limit_cycle);
}

static void hold(struct host *host) {
    while (must_wait(host) && !wants_end)
        sleep_s(0.0002);
}

static void keep_pace(struct host *host) {
    if (host->options.speed <= 0)
        return;
    double due_s = host->wall_start_s + simulated_s(host) / host->options.speed;
    double ahead_s = due_s - wall_s();
    if (ahead_s > 0.0002)
        sleep_s(ahead_s);
    else if (ahead_s < -CATCH_UP_S)
        host->wall_start_s += -ahead_s - CATCH_UP_S;
}

static int run(struct host *host) {
    host->wall_start_s = wall_s();
    double end_s = host->options.seconds > 0 ? host->options.seconds : 1e12;
    while (!wants_end && simulated_s(host) < end_s) {
        int alive = sim_run(host->sim, SLICE_CYCLES);
        plug_as_wanted(host);
        follow_client(host);
        carry_bytes(host);
        if (write_log(host))
            return 1;
        follow_shared(host); /* after the log: up to shared->cycle the log is complete */
        if (!alive)
            return complain("the AVR has stopped", "") != 0;
        wait_for_host(host);
        hold(host);
        keep_pace(host);
    }
    return 0;
}

/* ---- start and end ---- */

static int open_shared(struct host *host) {
    static struct shared nobody;
    host->shared = &nobody;
    if (!host->options.shared)
        return 0;
    int file = open(host->options.shared, O_RDWR | O_CREAT | O_CLOEXEC, 0644);
    if (file < 0 || ftruncate(file, SHARED_BYTES))
        return -1;
    void *mapped = mmap(NULL, SHARED_BYTES, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    close(file);
    host->shared = mapped;
    return mapped == MAP_FAILED ? -1 : 0;
}

static int open_all(struct host *host) {
    options_t *options = &host->options;
    host->log = -1;
    if (options->log)
        host->log = open(options->log, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
    if (options->log && host->log < 0)
        return complain("the log cannot be opened: ", strerror(errno));
    if (open_shared(host))
        return complain("the shared file cannot be mapped: ", strerror(errno));
    host->sim = sim_open(options->image, SIM_REPAIR_ALL);
    if (!host->sim)
        return complain("no image for the ATmega328P: ", options->image);
    follow_shared(host);
    if (tty_plug(&host->tty, options->link))
        return complain("no pty: ", strerror(errno));
    return 0;
}

static void report(const struct host *host, double took_s) {
    const sim_counters_t *counters = sim_counters(host->sim);
    fprintf(stderr,
            "simhost: %.3f s simulated in %.3f s; received %llu, sent %llu, overruns %llu, "
            "framing errors %llu, resets %llu, dropped %llu, waits in vain %d\n",
            simulated_s(host), took_s, (unsigned long long)counters->rx_bytes,
            (unsigned long long)counters->tx_bytes, (unsigned long long)counters->overruns,
            (unsigned long long)counters->framing_errors, (unsigned long long)counters->resets,
            (unsigned long long)host->tty.dropped, host->stalls);
}

int main(int count, char **words) {
    struct host host = {.options = {.speed = 1}};
    if (options_parse(&host.options, count, words))
        return 2;
    struct sigaction action = {.sa_handler = on_signal};
    for (const int *number = (const int[]){SIGTERM, SIGINT, SIGUSR1, SIGUSR2, 0}; *number; number++)
        sigaction(*number, &action, NULL);
    signal(SIGPIPE, SIG_IGN);
    prctl(PR_SET_PDEATHSIG, SIGTERM); /* no simulator outlives its test */
    if (open_all(&host))
        return 2;
    double began_s = wall_s();
    int failed = run(&host);
    report(&host, wall_s() - began_s);
    tty_unplug(&host.tty);
    sim_close(host.sim);
    return failed;
}
