/* Numbers of the bridge protocol; docs/bridge-protocol.md explains them.
 *
 * Rule 1: one `#define NAME number` a line, so that a test can compare them with the Python side.
 */
#ifndef PROTOCOL_H
#define PROTOCOL_H

#define PROTOCOL_VERSION 3

/* Bytes on the line. */
#define RESERVED_MASK 0xF8
#define RESERVED 0xB0
#define FLAG 0xB0
#define URGENT_STATUS 0xB3
#define URGENT_BRAKE 0xB5
#define ESCAPE 0xB7
#define URGENT_STOP 0xB6
#define ESCAPE_XOR 0x20

/* Frames. */
#define CRC_START 0xFFFF
#define PAYLOAD_MAX 80
#define WINDOW 192

/* Host to device. */
#define KIND_HELLO 0x01
#define KIND_TABLE 0x02
#define KIND_CARD 0x03
#define KIND_BLOCKS 0x04
#define KIND_START 0x05
#define KIND_RESUME 0x06
#define KIND_FLUSH 0x07
#define KIND_IDLE 0x08
#define KIND_OUTPUTS 0x09
#define KIND_MODE 0x0A
#define KIND_OVERRIDE 0x0B
#define KIND_PHASES 0x0C
#define KIND_PING 0x0D
#define KIND_CLOSE 0x0E
#define KIND_POWER 0x0F

/* Device to host. */
#define KIND_HELLO_REPLY 0x41
#define KIND_ACK 0x42
#define KIND_STATUS 0x43

/* HELLO reply: `capabilities`. */
#define ABLE_PHASES 0x01
#define ABLE_CLOCKS 0x02
#define ABLE_POWER 0x04

/* Why a command was refused. */
#define REFUSED_NO_HELLO 1
#define REFUSED_NO_CARD 2
#define REFUSED_PAYLOAD 3
#define REFUSED_MOVING 4
#define REFUSED_KIND 5
#define REFUSED_BLOCK 6
#define REFUSED_EPOCH 7

/* Flags of ACK. */
#define ACK_GAP 0x01

/* STATUS: `state`. */
#define STATE_MOVING 0x01
#define STATE_HELD 0x02
#define STATE_ENERGISED 0x04
#define STATE_BRAKING 0x08
#define STATE_SWITCH 0x10
#define STATE_LATCHED 0x20
#define STATE_TORN 0x40
#define STATE_DRY 0x80

/* STATUS: `more`. */
#define MORE_IN_HAND 0x01
#define MORE_CARD 0x02
#define MORE_CONTACT 0x04

/* STATUS: `ended`. */
#define ENDED_NOT 0
#define ENDED_TARGET 1
#define ENDED_SWITCH 2
#define ENDED_WATCH 3
#define ENDED_STOP 4
#define ENDED_FLUSH 5
#define ENDED_SILENCE 6

/* Records: `shape`. */
#define SHAPE_MOTORS 0x0F
#define SHAPE_WIDTH_SHIFT 4
#define SHAPE_RESTS 0x40
#define SHAPE_RARE 0x80
/* Records: `law`. */
#define LAW_PIECES 0x0F
#define LAW_ACCEL 0x10
#define LAW_JUMP 0x20
#define LAW_OVERRIDE 0x40
/* Records: `rare`. */
#define RARE_WATCH 0x01
#define RARE_OUTPUTS 0x02
#define RARE_ACCEL 0x04
#define RARE_JUMP 0x08
#define RARE_TOP 0x10
#define RARE_SHARE 0x20
#define RARE_ENERGY 0x40
/* Records: the head of a piece. */
#define PIECE_TICKS 0x03
#define PIECE_INTERVAL_SHIFT 2
#define PIECE_ADD_SHIFT 5
#define PIECE_RAMP 0x80
#define DRY_NONE 0xFF

/* Watches. */
#define WATCH_IGNORE 0
#define WATCH_STOP 1
#define WATCH_BRAKE 2

/* Cards. */
#define CARD_LENGTH 45
#define CARD_PHASES 0
#define CARD_CLOCKS 1
#define TABLE_MIN 2
#define TABLE_MAX 32
#define MOTORS_MAX 4
#define POWER_FULL 255
#define POWER_RATE 0x07
#define POWER_HIGH 0x80

#endif
