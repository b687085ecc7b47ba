/* Where the conversation stands: shared by commands and reports.
 *
 * Rule 1: all of it is forgotten at a reset; session 0 means that nobody has said HELLO.
 */
#ifndef LINK_H
#define LINK_H

#include <stdbool.h>
#include <stdint.h>

struct link {
    uint16_t session;
    uint8_t next_seq;
    uint8_t refused_seq, refused_code;
    bool gap;
    bool hello_due, ack_due, status_due;
    bool session_ends; /* after the next ACK */
};

extern struct link link;

#endif
