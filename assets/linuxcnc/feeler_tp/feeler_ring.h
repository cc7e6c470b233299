/* The shared memory between feeler_tp, which wraps LinuxCNC's trajectory planner, and feeler guard.
 *
 * SPDX-License-Identifier: 0BSD
 *
 * Permission to use, copy, modify, and/or distribute this file for any purpose with or without fee
 * is hereby granted. THE FILE IS PROVIDED "AS IS" AND THE AUTHOR DISCLAIMS ALL WARRANTIES WITH
 * REGARD TO THIS FILE, INCLUDING ALL IMPLIED WARRANTIES OF MERCHANTABILITY AND FITNESS. IN NO EVENT
 * SHALL THE AUTHOR BE LIABLE FOR ANY SPECIAL, DIRECT, INDIRECT, OR CONSEQUENTIAL DAMAGES OR ANY
 * DAMAGES WHATSOEVER RESULTING FROM LOSS OF USE, DATA OR PROFITS, WHETHER IN AN ACTION OF CONTRACT,
 * NEGLIGENCE OR OTHER TORTIOUS ACTION, ARISING OUT OF OR IN CONNECTION WITH THE USE OR PERFORMANCE
 * OF THIS FILE.
 *
 * The planner's side writes each motion that LinuxCNC queues into the ring and gives it a number.
 * The guard reads the motions in order. The planner gets a motion once the guard has permitted its
 * number, and not before: what it never got it cannot move.
 *
 * Each field has one writer. Counters are read with acquire and written with release order
 * (feeler_load, feeler_store); a segment is complete before `written` counts it, and is not
 * overwritten before `read` counts it.
 *
 * Lengths and positions are in the units of the machine (LINEAR_UNITS of its ini file), angles in
 * degrees. Positions are machine coordinates of X Y Z A B C U V W, as the planner has them: with
 * work offsets and tool offsets in them. With trivkins the axes move there. Other kinematics may
 * make X Y Z those of the tool's tip as seen from the work; what the joints do then is in
 * joint_from, joint_aside and joint_to.
 */
#ifndef FEELER_RING_H
#define FEELER_RING_H

#include <stdint.h>

#define FEELER_RING_KEY 0x46656c72 /* of the shared memory (System V) */
#define FEELER_RING_MAGIC 0x46656c72u
#define FEELER_RING_VERSION 3u
#define FEELER_RING_SEGMENTS 4096u
#define FEELER_JOINTS 16
/* Where joint_aside is: at this part of the straight way from `from` to `to`, which is no simple part
 * of a turn, and from there this far along X, Y and Z, so that it is near to no axis of rotation. */
#define FEELER_BETWEEN 0.381966011250105
#define FEELER_ASIDE {617.0, -468.0, 633.0}
/* Where axes besides X, Y and Z move, LinuxCNC leaves a corner by up to this many times its tolerance. */
#define FEELER_TURNING_CORNER 4.0
/* A corner of such motions is only blended if the rotary axes are in all nearer than this to where they
 * would be at the same place of the path, degrees, and U V W nearer than the tolerance. */
#define FEELER_TURN_ERROR 0.01

/* Shape of a path. A tap moves to `to` and back to `from`. */
enum feeler_shape { FEELER_LINE = 1, FEELER_ARC = 2, FEELER_TAP = 3 };

/* What a motion is for: LinuxCNC's own numbers, and one for probing until the contact is lost. */
enum feeler_purpose {
    FEELER_RAPID = 1,
    FEELER_FEED = 2,
    FEELER_CURVE = 3,
    FEELER_TOOL_CHANGE = 4,
    FEELER_PROBE = 5,
    FEELER_INDEXER = 6,
    FEELER_PROBE_AWAY = 7
};

/* How a motion may pass into the next one. */
enum feeler_blending { FEELER_EXACT_PATH = 0, FEELER_EXACT_STOP = 1, FEELER_BLENDED = 2 };

struct feeler_segment {
    uint64_t number;       /* 1, 2, 3 ... */
    uint64_t follows;      /* the motion that was made before it; after an abort an earlier one */
    uint32_t follows_part; /* 1: the abort ended that motion on its way */
    uint32_t from_rest;    /* 1: the axes were at rest, so no corner is rounded at its start */
    double stopped_at[9];  /* where an abort ended the motion that it follows */
    uint32_t shape, purpose, blending;
    int32_t line;          /* of the program */
    int32_t tool;          /* in the spindle; 0: none; -1: feeler-tp.tool-number is not connected */
    int32_t offset;        /* work offset in use: 540 for G54, 593 for G59.3 */
    int32_t turns;         /* of an arc: full turns before its end; negative: clockwise */
    uint32_t turns_on;     /* the spindle: 0 does not turn, 1 clockwise, 2 counterclockwise */
    double speed;          /* of the spindle, as commanded and overridden, 1/min */
    double feed;           /* as programmed, units per second */
    double most_speed, acceleration; /* LinuxCNC's limits for this motion, units per second (squared) */
    double tolerance;      /* of a blend; 0: none, as between rapids of a program that states none */
    double from[9], to[9];
    double centre[3], normal[3]; /* of an arc */
    double tool_length;          /* along Z, in use */
    /* Where the kinematics that LinuxCNC uses put the joints. */
    uint32_t joints; /* 0: they could not be asked, or have no answer */
    double joint_from[FEELER_JOINTS], joint_aside[FEELER_JOINTS], joint_to[FEELER_JOINTS];
};

struct feeler_ring {
    uint32_t magic, version;
    uint32_t bytes;    /* of this struct */
    uint32_t segments; /* FEELER_RING_SEGMENTS */
    uint64_t session;  /* 16 bits: another one each time LinuxCNC starts */

    /* written by feeler_tp */
    uint64_t written;   /* number of the last motion in the ring */
    uint64_t released;  /* number of the last motion that the planner got */
    uint64_t busy;      /* 1: the planner has motions that are not complete */
    uint64_t made;      /* all motions up to this number that were released were made */
    uint64_t dropped;   /* motions up to this number that were not released are gone */
    uint64_t cleared;   /* how often the operator cleared a violation (feeler-tp.clear) */
    uint64_t external;  /* 1: an external offset (eoffset) is in use, so nothing is released */
    uint64_t ended;     /* how often feeler_tp ended a program: the kinematics or an offset changed */
    uint64_t reserved[7];

    /* written by the guard */
    uint64_t read;      /* number of the last motion that was read */
    uint64_t permitted; /* feeler_permit: the planner may have all motions up to a number */
    uint64_t alive;     /* counts up while the guard runs */
    uint64_t latched;   /* 1: a violation was found and has not been cleared */
    uint64_t process;   /* id of the guard's process: one guard at a time */
    /* The tolerance with which feeds are blended where the program states none: with it, how far
     * they are rounded is known. */
    double feed_tolerance;
    double turn_tolerance; /* the same for motions of axes besides X, Y and Z, at most */
    uint64_t refused;      /* number of the motion that was refused last */
    uint64_t reserved_too[6];

    struct feeler_segment segment[FEELER_RING_SEGMENTS]; /* number n at n % FEELER_RING_SEGMENTS */
};

/* A permit is only valid in the session for which it was given. */
#define FEELER_NUMBER_BITS 48
#define feeler_permit(session, number) \
    ((uint64_t)(session) << FEELER_NUMBER_BITS | (uint64_t)(number))
#define feeler_permitted_number(permit) ((permit) & (((uint64_t)1 << FEELER_NUMBER_BITS) - 1))

#define feeler_load(counter) __atomic_load_n(counter, __ATOMIC_ACQUIRE)
#define feeler_store(counter, value) __atomic_store_n(counter, value, __ATOMIC_RELEASE)

#endif
