/* The board this is built for. */
#ifndef BOARD_H
#define BOARD_H

#if defined(BOARD_uno)
#include "boards/uno.h"
#elif defined(BOARD_mega)
#include "boards/mega.h"
#else
#error "make BOARD=uno or BOARD=mega"
#endif

#endif
