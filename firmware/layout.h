/* Where the assembler finds what C has laid out. player.c asserts every line of it.
 *
 * Rule 1: a struct that is read in beats.S has its offsets here, nowhere else.
 */
#ifndef LAYOUT_H
#define LAYOUT_H

/* struct block */
#define MINOR_SIZE 8
#define MINOR_SUM 0
#define MINOR_ADD 3
#define MINOR_MOVER 6
/* struct mover of clock lines: data bit, motor bit */
#define BLOCK_LEADER 24
#define BLOCK_LIMIT 26
#define BLOCK_MINORS 29

/* struct motor, and the table before the four of them */
#define MOTOR_PHASE 0
#define MOTOR_HIGH 1
#define MOTOR_BIT 2
#define MOTOR_LOW 3
#define TRACKS_MOTORS 32
#define TRACKS_SIZE 48

/* struct card, struct line */
#define CARD_TABLE_LENGTH 2
#define CARD_PULSE 28
#define CARD_CONTROL_HIGH 46
#define CARD_DATA 48
#define LINE_HEAD 0
#define LINE_ERRORS 2
#define LINE_BYTES 3
#define LINE_RING 64

/* struct player */
#define PLAYER_MODE 0
#define PLAYER_BLOCK 1
#define PLAYER_DUE 3
#define PLAYER_DONE 5
#define PLAYER_PIECE_END 8
#define PLAYER_RAMPS 11
#define PLAYER_INTERVAL 12
#define PLAYER_ADD 16
#define PLAYER_CYCLES 20
#define PLAYER_LAST 24
#define PLAYER_BEATS 28
#define PLAYER_BEATS_LEFT 29
#define PLAYER_BEAT_CYCLES 30
#define PLAYER_LAG 32
#define PLAYER_MOVED 33
#define PLAYER_LATE 34
#define PLAYER_SHORTEST 36
#define PLAYER_PATIENCE 38
#define PLAYER_LATE_TICKS 39
#define PLAYER_EARLY 41
#define PLAYER_PLAN 42
#define PLAYER_FALL 46
#define PLAYER_NOT_BEFORE 50
#define PLAYER_IS_MADE_OUT 54
#define PLAYER_WAIT 55

/* player.mode: what the next interrupt is */
#define MODE_PHASES 0
#define MODE_SLOW 1
#define MODE_HOP 2
#define MODE_RISE 3
#define MODE_FALL 4
#define MODE_FAST_RISE 5
#define MODE_FAST_FALL 6

/* player.ramps */
#define RAMP_NONE 0
#define RAMP_FAST 1
#define RAMP_SLOW 2 /* every tick is taken by C */
/* Clock lines at a constant interval: after one tick the fall, after two the wait is the same. */
#define RAMP_SETTLING 3
#define RAMP_STEADY 4

/* struct beat */
#define BEAT_ENTRY 3
#define BEAT_END 12
#define BEAT_MASK 13
#define BEAT_QUIET 14
#define BEAT_RESTLESS 15
#define BEAT_MIND 16
#define BEAT_PINS 17
#define BEAT_REST 24 /* struct entry rest: clock lines at rest */
#define BEAT_SIZE 30

/* From the compare match to the deadline: entry, the longest lock, what is done before the wait. */
#define EARLY_CYCLES 60
#define EARLY_SLOW_CYCLES 170 /* where C does it */
/* No compare match is set closer than this: it might pass while it is being set. */
#define NEAR_CYCLES 8
/* After so many beats without a turn of the main loop it gets one. */
#define PATIENCE 64
#define GIVEN_CYCLES 240
/* Waits of FAR_HIGH << 8 cycles and more go in hops: differences of times have a sign. */
#define FAR_HIGH 0x70

#endif
