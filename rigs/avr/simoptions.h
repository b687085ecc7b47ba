/* The command line of simhost.
 *
 *   simhost IMAGE --link PATH [--log PATH] [--shared PATH] [options]
 *
 *     --link PATH         where the serial port appears
 *     --log PATH          the log, as sim_event_t records: a file that grows, or a fifo
 *     --shared PATH       a file of SHARED_BYTES bytes, mapped: see struct shared
 *     --speed X           times real time; 0 is as fast as it goes; default 1
 *     --stall-ms N        lock step: when the AVR has spoken and the line is idle, wait so
 *                         long for the host before simulated time goes on; default 0
 *     --boot-ms N         after a reset by DTR nobody listens for so long, as with a boot loader
 *     --mark BYTE         tells in the shared file when the client sent this byte; 0: none
 *     --keep-running      opening the port does not reset the AVR
 *     --any-baud          whatever baud rate the client sets is right
 *     --unplug-after S    the serial port vanishes after S simulated seconds
 *     --seconds S         ends by itself after S simulated seconds
 */
#ifndef SIMOPTIONS_H
#define SIMOPTIONS_H

typedef struct {
    const char *image, *link, *log, *shared;
    double speed, unplug_after_s, seconds;
    int stall_ms, boot_ms, mark, keep_running, any_baud;
} options_t;

/* Answers 0, or -1 after saying on stderr which word is wrong. */
int options_parse(options_t *options, int count, char **words);
/* Says what is wrong, and answers -1. */
int complain(const char *problem, const char *word);

#endif
