/* The life of a run: start, block after block, hold, finish, standstill; and who asks for it.
 *
 *        START          last block played, stop, watch, switch, silence
 *   still ---> settling ---> moving ----------------------------------> still
 *                              |  ^                                       ^
 *                        brake |  | resume, or blocks after running dry   |
 *                              v  |           stop, flush, silence        |
 *                              held --------------------------------------'
 *
 * Rule 1: the interrupt plays and halts; what follows a halt is done here, in the main loop.
 * Rule 2: a run ends in one place, run_finish. Whatever is dropped there raises the epoch, so that
 *         blocks which were on their way belong to no queue.
 * Rule 3: the host's silence ends a run by a brake, and takes the current off.
 */
#ifndef RUN_H
#define RUN_H

#include "state.h"

enum run_state { STANDING, SETTLING, MOVING };

struct run {
    uint8_t state;
    uint8_t ended;
    uint8_t epoch;
    bool torn;
    uint8_t torn_serial;
    bool silenced;
    uint8_t version; /* changes with all that a report should tell at once */
    uint8_t brakes, stops;
    uint32_t now;    /* cycles, by the main loop */
    uint32_t life;   /* of the host's last valid byte */
};

extern struct run run;

/* In the main loop. */
void run_service(void);
void run_time(void);
void run_start(void);
void run_resume(void);
void run_brake(void);
void run_stop(void);
bool run_flush(void);
void run_set_outputs(uint8_t mask, uint8_t value);
/* A block has come. */
void run_refilled(void);
/* A block that cannot be played as it says. */
void run_refuse_block(void);
/* A card was loaded. */
void run_take_card(void);
/* The session begins anew, or ends. */
void run_forget(void);
void run_close(void);

/* In the interrupt. */
void run_make_outputs(void);
void run_make_block_outputs(struct block *block);
void run_set_up(const struct block *block);
void run_show_ramp(void);

static inline bool run_is_moving(void)
{
    return run.state != STANDING;
}

#endif
