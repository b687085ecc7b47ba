/* Where the assembler finds what C has laid out. layout.c asserts every line of it.
 *
 * Rule 1: a struct that is read in beats.S has its offsets here, nowhere else.
 */
#ifndef LAYOUT_H
#define LAYOUT_H

/* struct block, and struct minor of which it begins with three */
#define MINOR_SIZE 8
#define MINOR_SUM 0
#define MINOR_ADD 3
#define MINOR_MOVER 6
#define BLOCK_LEADER 24
#define BLOCK_LIMIT 26
#define BLOCK_NARROW 29
#define BLOCK_WIDE 30
#define BLOCK_RAMPS 31
#define BLOCK_PIECE_END 32
#define BLOCK_INTERVAL 35
#define BLOCK_ADD 39
#define BLOCK_PIECE_IS_LAST 43
#define BLOCK_BEATS 44
#define BLOCK_BEAT_CYCLES 45
#define BLOCK_LAG 47
#define BLOCK_SHORTEST 48
#define BLOCK_SERIAL 50
#define BLOCK_OUTPUTS_DUE 52
#define BLOCK_ENTRY 53
#define BLOCK_IS_RAMP 57

/* struct piece */
#define PIECE_END 0
#define PIECE_INTERVAL 3
#define PIECE_ADD 7
#define PIECE_LAST 11
#define PIECE_RAMPS 12
#define PIECE_IS_RAMP 13
#define PIECE_SIZE 14
#define PIECES 4

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
#define CARD_CONTROL 47
#define CARD_CONTROL_HIGH 48
#define CARD_DATA 50
#define CARD_BOOST 51
#define CARD_BOOST_HIGH 52
#define LINE_HEAD 0
#define LINE_ERRORS 2
#define LINE_BYTES 3
#define LINE_RING 64

/* struct player */
#define PLAYER_BLOCK 0
#define PLAYER_NEXT 2
#define PLAYER_TAKEN 4
#define PLAYER_IS_MINDED 5
#define PLAYER_LIMITS_OWED 6
#define PLAYER_SERIAL 7
#define PLAYER_DUE 9
#define PLAYER_DONE 11
#define PLAYER_CHOSEN_AT 14
#define PLAYER_CYCLES 17
#define PLAYER_LAST 21
#define PLAYER_BEATS_LEFT 25
#define PLAYER_MOVED 26
#define PLAYER_LATE 27
#define PLAYER_PATIENCE 29
#define PLAYER_LATE_TICKS 30
#define PLAYER_EARLY 32
#define PLAYER_FALL 33
#define PLAYER_IS_MADE_OUT 37
#define PLAYER_WAIT 38

/* struct throttle */
#define THROTTLE_DRY_POINT 0
#define THROTTLE_DRY_SERIAL 1
#define THROTTLE_DRY_TICK 3
#define THROTTLE_TURN 7
#define THROTTLE_IS_STEADY 8
#define THROTTLE_STEADY_UNTIL 9
#define THROTTLE_ELAPSED 13
#define THROTTLE_MARK 17
#define THROTTLE_RATE_OWED 21
/* From the decision of a move until it counts, where beats.S decides: at high rates the main loop has
 * little time for it. */
#define THROTTLE_AHEAD 8192

/* What the next interrupt is. Bits tell those apart that beats.S plays itself. */
#define MODE_PHASES 0
#define MODE_SLOW 1
#define MODE_HOP 2
#define MODE_RISE 3
#define MODE_FALL 4
#define MODE_RISES 7 /* bit */
#define MODE_FALLS 6 /* bit */
#define MODE_CONTROLS 5 /* bit */
#define MODE_CONTROL 0x20
#define MODE_FAST_RISE 0x80
#define MODE_FAST_FALL 0x40   /* the next edge is made out */
#define MODE_STEADY_FALL 0x41 /* likewise, and the wait until then is known */
#define MODE_LAST_FALL 0x42   /* of its piece: nothing is made out */
#define MODE_NEXT_FALL 0x43   /* likewise, but the next block is in hand already */

/* block.ramps */
#define RAMP_NONE 0
#define RAMP_FAST 1
#define RAMP_SLOW 2 /* every tick is taken by C */
/* Clock lines at a constant interval: pulse and pause are known. */
#define RAMP_STEADY 3
/* Bit in a piece's ramps, with clock lines: BOOST changes with its begin. */
#define RAMP_TURNS 7

/* struct beat */
#define BEAT_ENTRY 2
#define BEAT_END 8
#define BEAT_MASK 9
#define BEAT_QUIET 10
#define BEAT_RESTLESS 11
#define BEAT_MIND 12
#define BEAT_PINS 13
#define BEAT_REST 17 /* struct entry rest: clock lines at rest */
#define BEAT_CONTROL_DUE 19
#define BEAT_CONTROL_HIGH 20
#define BEAT_CONTROL_EXTRA 21
#define BEAT_SIZE 22

/* From the compare match to the deadline: entry, an instruction, the longest lock, what is done
 * before the wait; less what the wait adds (wait_out: 16). */
#define EARLY_CYCLES 42
#define EARLY_CLOCKS_CYCLES 50 /* with clock lines: the way there is longer */
#define EARLY_SLOW_CYCLES 200 /* where C does it */
/* No compare match is set closer than this: it might pass while it is being set. */
#define NEAR_CYCLES 8
/* After so many beats without a turn of the main loop it gets one. */
#define PATIENCE 64
#define GIVEN_CYCLES 240
/* Waits of FAR_HIGH << 8 cycles and more go in hops: differences of times have a sign. */
#define FAR_HIGH 0x70

#endif
