/* layout.h, line by line, against what the compiler lays out. */
#include <stddef.h>

#include "beat.h"
#include "card.h"
#include "layout.h"
#include "line.h"
#include "player.h"
#include "throttle.h"

#define AT(type, field, offset) \
    _Static_assert(offsetof(struct type, field) == (offset), #type "." #field)
#define SIZE(type, size) _Static_assert(sizeof(struct type) == (size), #type)

AT(minor, sum, MINOR_SUM);
AT(minor, add, MINOR_ADD);
AT(minor, mover, MINOR_MOVER);
SIZE(minor, MINOR_SIZE);

AT(block, leader, BLOCK_LEADER);
AT(block, limit, BLOCK_LIMIT);
AT(block, narrow, BLOCK_NARROW);
AT(block, wide, BLOCK_WIDE);
AT(block, ramps, BLOCK_RAMPS);
AT(block, piece_end, BLOCK_PIECE_END);
AT(block, interval_q8, BLOCK_INTERVAL);
AT(block, add_q8, BLOCK_ADD);
AT(block, piece_is_last, BLOCK_PIECE_IS_LAST);
AT(block, beats, BLOCK_BEATS);
AT(block, beat_cycles, BLOCK_BEAT_CYCLES);
AT(block, lag_cycles, BLOCK_LAG);
AT(block, shortest, BLOCK_SHORTEST);
AT(block, serial, BLOCK_SERIAL);
AT(block, outputs_due, BLOCK_OUTPUTS_DUE);
AT(block, entry_cycles, BLOCK_ENTRY);
AT(block, is_ramp, BLOCK_IS_RAMP);

AT(piece, end, PIECE_END);
AT(piece, interval_q8, PIECE_INTERVAL);
AT(piece, add_q8, PIECE_ADD);
AT(piece, last, PIECE_LAST);
AT(piece, ramps, PIECE_RAMPS);
AT(piece, is_ramp, PIECE_IS_RAMP);
SIZE(piece, PIECE_SIZE);

AT(motor, phase, MOTOR_PHASE);
AT(motor, high, MOTOR_HIGH);
AT(motor, bit, MOTOR_BIT);
AT(motor, low, MOTOR_LOW);

AT(tracks, motor, TRACKS_MOTORS);
SIZE(tracks, TRACKS_SIZE);

AT(card, facts.table_length, CARD_TABLE_LENGTH);
AT(card, facts.pulse_cycles, CARD_PULSE);
AT(card, control_high, CARD_CONTROL_HIGH);
AT(card, data, CARD_DATA);
AT(card, control, CARD_CONTROL);
AT(card, boost_mask, CARD_BOOST);
AT(card, boost_high, CARD_BOOST_HIGH);

AT(line, head, LINE_HEAD);
AT(line, errors, LINE_ERRORS);
AT(line, bytes, LINE_BYTES);

AT(player, block, PLAYER_BLOCK);
AT(player, next, PLAYER_NEXT);
AT(player, taken, PLAYER_TAKEN);
AT(player, is_minded, PLAYER_IS_MINDED);
AT(player, limits_owed, PLAYER_LIMITS_OWED);
AT(player, serial, PLAYER_SERIAL);
AT(player, due, PLAYER_DUE);
AT(player, done, PLAYER_DONE);
AT(player, chosen_at, PLAYER_CHOSEN_AT);
AT(player, cycles, PLAYER_CYCLES);
AT(player, last_cycles, PLAYER_LAST);
AT(player, beats_left, PLAYER_BEATS_LEFT);
AT(player, moved, PLAYER_MOVED);
AT(player, late, PLAYER_LATE);
AT(player, patience, PLAYER_PATIENCE);
AT(player, late_ticks, PLAYER_LATE_TICKS);
AT(player, early, PLAYER_EARLY);
AT(player, fall_cycles, PLAYER_FALL);
AT(player, is_made_out, PLAYER_IS_MADE_OUT);
AT(player, wait_cycles, PLAYER_WAIT);

AT(throttle, dry_point, THROTTLE_DRY_POINT);
AT(throttle, dry_serial, THROTTLE_DRY_SERIAL);
AT(throttle, dry_tick, THROTTLE_DRY_TICK);
AT(throttle, is_steady, THROTTLE_IS_STEADY);
AT(throttle, steady_until, THROTTLE_STEADY_UNTIL);
AT(throttle, elapsed, THROTTLE_ELAPSED);
AT(throttle, mark, THROTTLE_MARK);
AT(throttle, turn, THROTTLE_TURN);
AT(throttle, rate_owed, THROTTLE_RATE_OWED);

AT(beat, end, BEAT_END);
AT(beat, mask, BEAT_MASK);
AT(beat, quiet, BEAT_QUIET);
AT(beat, restless, BEAT_RESTLESS);
AT(beat, mind, BEAT_MIND);
AT(beat, pins, BEAT_PINS);
AT(beat, rest, BEAT_REST);
AT(beat, control_due, BEAT_CONTROL_DUE);
AT(beat, control_high, BEAT_CONTROL_HIGH);
AT(beat, control_extra, BEAT_CONTROL_EXTRA);
SIZE(entry, BEAT_ENTRY);
SIZE(beat, BEAT_SIZE);
