/* feeler_tp: wraps LinuxCNC's trajectory planner, so that it gets a motion only once `feeler guard`
 * has permitted it.
 *
 * Copyright (C) 2026 the Feeler developers
 * SPDX-License-Identifier: GPL-2.0-or-later
 *
 * The module has all functions of tpmod and passes them on to it. Motions do not go to the planner
 * directly: they wait here, with all that was set between them, and are written to the ring in
 * shared memory (feeler_ring.h). Each cycle passes on what has been permitted. So the planner comes
 * to rest at the end of the last permitted motion by itself, whatever it is doing: override, blends,
 * threads, limits of jerk. Nothing in a program, and no end of the guard, makes it go further.
 *
 * Install: halcompile --install feeler_tp.c
 * Use:     [TRAJ] TPMOD = feeler_tp
 *          net tool-number iocontrol.0.tool-number => feeler-tp.tool-number
 */
#include <dlfcn.h>
#include <math.h>
#include <stddef.h>
#include <string.h>
#include <time.h>

#include "rtapi.h"
#include "rtapi_app.h"
#include "hal.h"
#include "kinematics.h"
#include "motion.h"
#include "tp.h"

#include "feeler_ring.h"

MODULE_AUTHOR("the Feeler developers");
MODULE_DESCRIPTION("trajectory planner that waits for the permits of feeler guard");
MODULE_LICENSE("GPL");

/* The functions of the planner as of LinuxCNC 2.9. Headers of another version do not compile. */
#define PLANNER(F)                                                                                \
    F(int, tpCreate, (TP_STRUCT *, int, int))                                                      \
    F(int, tpClear, (TP_STRUCT *))                                                                 \
    F(int, tpSetCycleTime, (TP_STRUCT *, double))                                                  \
    F(int, tpSetVmax, (TP_STRUCT *, double, double))                                               \
    F(int, tpSetVlimit, (TP_STRUCT *, double))                                                     \
    F(int, tpSetAmax, (TP_STRUCT *, double))                                                       \
    F(int, tpSetId, (TP_STRUCT *, int))                                                            \
    F(int, tpGetExecId, (TP_STRUCT *))                                                             \
    F(struct state_tag_t, tpGetExecTag, (TP_STRUCT *))                                             \
    F(int, tpSetTermCond, (TP_STRUCT *, int, double))                                              \
    F(int, tpSetPos, (TP_STRUCT *, EmcPose const *))                                               \
    F(int, tpRunCycle, (TP_STRUCT *, long))                                                        \
    F(int, tpPause, (TP_STRUCT *))                                                                 \
    F(int, tpResume, (TP_STRUCT *))                                                                \
    F(int, tpAbort, (TP_STRUCT *))                                                                 \
    F(int, tpAddRigidTap, (TP_STRUCT *, EmcPose, double, double, double, unsigned char, double,    \
                           struct state_tag_t))                                                    \
    F(int, tpAddLine, (TP_STRUCT *, EmcPose, int, double, double, double, unsigned char, char,     \
                       int, struct state_tag_t))                                                   \
    F(int, tpAddCircle, (TP_STRUCT *, EmcPose, PmCartesian, PmCartesian, int, int, double, double, \
                         double, unsigned char, char, struct state_tag_t))                         \
    F(int, tpGetPos, (TP_STRUCT const *, EmcPose *))                                               \
    F(int, tpIsDone, (TP_STRUCT *))                                                                \
    F(int, tpQueueDepth, (TP_STRUCT *))                                                            \
    F(int, tpActiveDepth, (TP_STRUCT *))                                                           \
    F(int, tpGetMotionType, (TP_STRUCT *))                                                         \
    F(int, tpSetSpindleSync, (TP_STRUCT *, int, double, int))                                      \
    F(int, tpSetAout, (TP_STRUCT *, unsigned char, double, double))                                \
    F(int, tpSetDout, (TP_STRUCT *, int, unsigned char, unsigned char))                            \
    F(int, tpSetRunDir, (TP_STRUCT *, tc_direction_t))                                             \
    F(void, tpMotFunctions, (void (*)(int, char), void (*)(int, double), void (*)(int, int),       \
                             int (*)(int), double (*)(int), double (*)(int)))                      \
    F(void, tpMotData, (emcmot_status_t *, emcmot_config_t *))                                     \
    F(int, tcqFull, (TC_QUEUE_STRUCT const *))

#define DECLARE(result, name, arguments)                                                          \
    static result(*real_##name) arguments;                                                         \
    _Static_assert(__builtin_types_compatible_p(__typeof__(&name), result(*) arguments),           \
                   "this version of LinuxCNC is not known: " #name);
PLANNER(DECLARE)

/* The number of a motion travels in the upper half of its tag's flags, of which LinuxCNC uses less
 * than 32. */
_Static_assert(sizeof(unsigned long) == 8, "feeler_tp needs a 64-bit system");
_Static_assert(GM_FLAG_MAX_FLAGS <= 32, "this version of LinuxCNC has too many flags");
_Static_assert(EMCMOT_MAX_JOINTS == FEELER_JOINTS, "this version of LinuxCNC is not known: joints");
#define NUMBER_SHIFT 32

/* --- what waits --------------------------------------------------------------------------------*/

enum what { ADD_LINE, ADD_CIRCLE, ADD_TAP, SET_ID, SET_TERM_COND, SET_SYNC, SET_AOUT, SET_DOUT };

struct call {
    enum what what;
    uint64_t number; /* of a motion */
    int id;
    EmcPose end;
    PmCartesian centre, normal;
    EmcPose begin;
    int turn, type, index;
    int blends;       /* with the next one */
    int keeps_path;   /* no corner at its end is rounded, though the program allows that */
    int may_be_round; /* passed on so that the corner at its end is rounded */
    double vel, max_vel, acc, scale, from, to, tolerance;
    unsigned char enables, start, stop;
    char at_speed;
    struct state_tag_t tag;
};

#define CALLS 4096
#define CALLS_IN_RESERVE 64
static struct call calls[CALLS];
static unsigned first_call, call_count, motion_count; /* motions among the calls */

static struct call *call_at(unsigned i) { return &calls[(first_call + i) % CALLS]; }
static int is_motion(struct call const *c) { return c->what <= ADD_TAP; }

/* The first motion that waits; there must be one. */
static struct call *first_motion(void) {
    unsigned i = 0;
    while (!is_motion(call_at(i))) ++i;
    return call_at(i);
}

static struct call *new_call(enum what what) {
    if (call_count == CALLS) return NULL;
    struct call *c = call_at(call_count++);
    memset(c, 0, sizeof *c);
    c->what = what;
    return c;
}

/* --- state -------------------------------------------------------------------------------------*/

struct pins {
    hal_s32_t *tool_number;
    hal_bit_t *clear, *holding, *guard_alive, *latched;
    hal_s32_t *line;
};
static struct pins *pins;

static int component, memory = -1;
static void *planner;
static struct feeler_ring *ring;
static emcmot_status_t *status;
static emcmot_config_t *settings;
static __typeof__(&kinematicsInverse) kinematics; /* of the machine; NULL: not found */

static TP_STRUCT *the_tp; /* the one planner that there is */
static EmcPose goal;      /* the end of the last motion that was accepted */
static uint64_t accepted; /* number of the last motion; the guard does not know a new probe yet */
static int is_probe_new;
static int next_id, term_cond = TC_TERM_COND_PARABOLIC; /* as after tpInit */
static double tolerance;
static int is_aborting;
static uint64_t last_begun; /* the motion that the axes began last */
static int was_dropped; /* motions were, since the last one was accepted */
static int was_stopped; /* that ended `last_begun` on its way, and nothing was released since */
static EmcPose stopped_at;
static int is_pausing;     /* by the operator */
static int was_refused;    /* the planner refused a motion since the last one was accepted */
static uint64_t released_at_stop = UINT64_MAX; /* motions after `last_begun` were not made */
static double state_of_queued[FEELER_JOINTS]; /* find_state() for the motions that wait or are made */
static int was_state_known;
static struct call last_passed; /* the motion that the planner got last */
static int was_clear_pressed;
static uint64_t last_alive;
static long long alive_at; /* when the guard gave its last sign of life, nanoseconds */
static long long const second = 1000000000LL;
static long long waits_since; /* until now no motion has waited without a guard */
static int has_said_why, has_said_end;

static void copy_pose(double *to, EmcPose const *pose) {
    double const values[9] = {pose->tran.x, pose->tran.y, pose->tran.z, pose->a, pose->b,
                              pose->c,      pose->u,      pose->v,      pose->w};
    memcpy(to, values, sizeof values);
}

static int is_same_pose(EmcPose const *a, EmcPose const *b) {
    double p[9], q[9];
    copy_pose(p, a);
    copy_pose(q, b);
    for (int i = 0; i < 9; ++i)
        if (p[i] - q[i] > TP_POS_EPSILON || q[i] - p[i] > TP_POS_EPSILON) return 0;
    return 1;
}

/* Where the machine's kinematics put the joints, in their present mode. 0: nowhere. */
static int find_joints(double (*joint)[FEELER_JOINTS], EmcPose const *pose) {
    double all[EMCMOT_MAX_JOINTS] = {0};
    KINEMATICS_INVERSE_FLAGS const inverse = 0;
    KINEMATICS_FORWARD_FLAGS forward = 0;
    if (!kinematics || kinematics(pose, all, &inverse, &forward) != 0) return 0;
    memcpy(*joint, all, sizeof *joint);
    return 1;
}

static EmcPose pose_aside(EmcPose const *a, EmcPose const *b) {
    EmcPose p;
    double const t = FEELER_BETWEEN;
    p.tran.x = a->tran.x + t * (b->tran.x - a->tran.x);
    p.tran.y = a->tran.y + t * (b->tran.y - a->tran.y);
    p.tran.z = a->tran.z + t * (b->tran.z - a->tran.z);
    p.a = a->a + t * (b->a - a->a);
    p.b = a->b + t * (b->b - a->b);
    p.c = a->c + t * (b->c - a->c);
    p.u = a->u + t * (b->u - a->u);
    p.v = a->v + t * (b->v - a->v);
    p.w = a->w + t * (b->w - a->w);
    double const aside[3] = FEELER_ASIDE;
    p.tran.x += aside[0], p.tran.y += aside[1], p.tran.z += aside[2];
    return p;
}

/* What tells one state of the kinematics from another: where they put the joints at some place. */
static int find_state(double (*joint)[FEELER_JOINTS]) {
    EmcPose place;
    memset(&place, 0, sizeof place);
    place.tran.x = 311.0, place.tran.y = -173.0, place.tran.z = 229.0;
    place.a = 31.0, place.b = 43.0, place.c = 59.0;
    place.u = 11.0, place.v = 13.0, place.w = 17.0;
    return find_joints(joint, &place);
}

/* Whether the kinematics are another ones, or with other pins, than those for which motions were
 * queued. */
static int have_kinematics_changed(void) {
    double now[FEELER_JOINTS];
    int const is_known = find_state(&now);
    if (is_known != was_state_known) return 1;
    for (int i = 0; is_known && i < FEELER_JOINTS; ++i)
        if (!(fabs(now[i] - state_of_queued[i]) <= 1e-6)) return 1;
    return 0;
}

/* Whether axes besides X, Y and Z move. */
static int moves_others(struct call const *c) {
    double p[9], q[9];
    copy_pose(p, &c->begin);
    copy_pose(q, &c->end);
    for (int i = 3; i < 9; ++i)
        if (p[i] != q[i]) return 1;
    return 0;
}

/* How far such axes may be, while a corner is blended, from where they are at the same place of the
 * path: A, B and C in all, degrees, and U, V and W. Measured with the planner (tests/guard): it leaves
 * a corner of the turn f with the tolerance T within 2 T / sin(f/2) of it. */
static void find_errors(struct call const *before, struct call const *after, double (*error)[2]) {
    double p[9], q[9], r[9], square_before = 0, square_after = 0, product = 0;
    copy_pose(p, &before->begin);
    copy_pose(q, &before->end);
    copy_pose(r, &after->end);
    for (int i = 0; i < 3; ++i) {
        square_before += (q[i] - p[i]) * (q[i] - p[i]);
        square_after += (r[i] - q[i]) * (r[i] - q[i]);
        product += (q[i] - p[i]) * (r[i] - q[i]);
    }
    double first = sqrt(square_before), second = sqrt(square_after);
    int const begins = first < TP_POS_EPSILON, ends = second < TP_POS_EPSILON; /* without X, Y, Z */
    (*error)[0] = (*error)[1] = 0;
    if (begins != ends) {
        for (int i = 3; i < 9; ++i) (*error)[i / 6] += fabs(q[i] - p[i]) + fabs(r[i] - q[i]);
        return;
    }
    if (begins) { /* a straight path of the other axes cannot be left */
        square_before = square_after = 0;
        for (int i = 3; i < 9; ++i) {
            square_before += (q[i] - p[i]) * (q[i] - p[i]);
            square_after += (r[i] - q[i]) * (r[i] - q[i]);
        }
        first = sqrt(square_before), second = sqrt(square_after);
        for (int i = 3; i < 9; ++i)
            (*error)[i / 6] +=
                fmin(first, second) * fabs((r[i] - q[i]) / second - (q[i] - p[i]) / first);
        return;
    }
    double const cosine = fmax(-1.0, fmin(1.0, product / (first * second)));
    double const half_sine = sqrt(0.5 * (1.0 - cosine));
    double part = fmin(first, second);
    if (half_sine * part > 2.0 * before->tolerance) part = 2.0 * before->tolerance / half_sine;
    for (int i = 3; i < 9; ++i) {
        double const rate = (q[i] - p[i]) / first, next = (r[i] - q[i]) / second;
        (*error)[i / 6] += part * (fabs(next - rate) + fmax(fabs(rate), fabs(next)) * (1.0 - cosine));
    }
}

/* Whether a motion must begin at rest, after another: LinuxCNC would blend the two, and how far X, Y
 * and Z are off at an arc, or other axes anywhere, is not limited by the tolerance. */
static int must_rest_before(struct call const *after, struct call const *before) {
    int const is_rapid = after->type == FEELER_RAPID, was_rapid = before->type == FEELER_RAPID;
    if (!before->blends || is_rapid != was_rapid) return 0; /* not blended in any case */
    if (!moves_others(after) && !moves_others(before))
        return after->what == ADD_CIRCLE && before->may_be_round;
    if (after->what != ADD_LINE || before->what != ADD_LINE) return 1;
    if (!moves_others(after) || !moves_others(before)) return 1;
    double error[2];
    find_errors(before, after, &error);
    return !(error[0] <= FEELER_TURN_ERROR && error[1] <= before->tolerance);
}

/* LinuxCNC's way back to 0 ends up to 1e-5 before it, depending on the acceleration of the axis. */
static int has_external_offset(void) {
    double const negligible = 2e-5; /* of a unit or a degree */
    double offset[9];
    if (!status) return 0;
    copy_pose(offset, &status->eoffset_pose);
    for (int i = 0; i < 9; ++i)
        if (!(offset[i] <= negligible && offset[i] >= -negligible)) return 1;
    return 0;
}

/* The number of the motion that the planner makes now; 0: none, or not known. */
static uint64_t executing(TP_STRUCT *tp) {
    if (real_tpIsDone(tp)) return 0;
    uint32_t const low = real_tpGetExecTag(tp).packed_flags >> NUMBER_SHIFT;
    /* The last motion that was released is at most 2^31 ahead. */
    return ring->released - (uint32_t)((uint32_t)ring->released - low);
}

/* Notes where the axes came to rest. If the planner `was_busy`, that was before the end of a motion,
 * and motions behind it were not made; 0: it is not known which, so the last one that is known. */
static void note_stop(TP_STRUCT *tp, int was_busy, uint64_t motion) {
    real_tpGetPos(tp, &goal);
    if (!was_busy) return;
    released_at_stop = ring->released;
    if (!motion) return;
    last_begun = motion;
    was_stopped = 1;
    stopped_at = goal;
}

/* --- accepting motions -------------------------------------------------------------------------*/

static int is_full(void) {
    return call_count > CALLS - CALLS_IN_RESERVE
           || accepted - feeler_load(&ring->read) >= FEELER_RING_SEGMENTS - CALLS_IN_RESERVE;
}

static struct feeler_segment *next_segment(void) {
    uint64_t const number = accepted + 1;
    if (number - feeler_load(&ring->read) > FEELER_RING_SEGMENTS) return NULL;
    return &ring->segment[number % FEELER_RING_SEGMENTS];
}

/* Shows a probing motion to the guard. LinuxCNC says of which kind it is only after it was queued. */
static void show_probe(void) {
    if (!is_probe_new) return;
    is_probe_new = 0;
    if (status->probe_type & 2)
        ring->segment[accepted % FEELER_RING_SEGMENTS].purpose = FEELER_PROBE_AWAY;
    feeler_store(&ring->written, accepted);
}

/* Gives a motion its number and shows it to the guard. */
static int accept_motion(struct call *c, enum feeler_shape shape) {
    show_probe();
    struct feeler_segment *s = next_segment();
    if (!s) {
        --call_count;
        return TP_ERR_FAIL;
    }
    memset(s, 0, sizeof *s);
    s->number = c->number = accepted + 1;
    s->follows = was_dropped ? last_begun : c->number - 1;
    if (was_dropped && was_stopped) {
        s->follows_part = 1;
        copy_pose(s->stopped_at, &stopped_at);
    }
    was_dropped = 0;
    s->shape = shape;
    s->purpose = shape == FEELER_TAP ? FEELER_FEED : c->type;
    s->blending = term_cond == TC_TERM_COND_STOP    ? FEELER_EXACT_STOP
                  : term_cond == TC_TERM_COND_EXACT ? FEELER_EXACT_PATH
                                                    : FEELER_BLENDED;
    c->keeps_path = s->blending == FEELER_BLENDED && shape == FEELER_ARC;
    if (c->keeps_path) s->blending = FEELER_EXACT_PATH;
    s->line = c->tag.fields[GM_FIELD_LINE_NUMBER];
    s->tool = *pins->tool_number;
    s->offset = c->tag.fields[GM_FIELD_ORIGIN];
    s->turns = c->turn;
    /* LinuxCNC starts and stops the spindle only once all motions before that were made. */
    if (status) {
        int const direction = status->spindle_status[0].direction;
        double const speed =
            status->spindle_status[0].speed * status->spindle_status[0].net_scale;
        s->turns_on = direction > 0 ? 1 : direction < 0 ? 2 : 0;
        s->speed = speed < 0.0 ? -speed : speed;
    }
    s->feed = c->vel;
    s->most_speed = c->max_vel;
    s->acceleration = c->acc;
    c->begin = goal;
    /* Rapids and feeds are never blended with each other. */
    c->blends = s->blending == FEELER_BLENDED;
    c->tolerance = tolerance;
    if (c->blends && tolerance == 0.0 && (s->purpose != FEELER_RAPID || moves_others(c)))
        c->tolerance = ring->feed_tolerance;
    if (c->blends && moves_others(c)) c->tolerance = fmin(c->tolerance, ring->turn_tolerance);
    s->tolerance = c->tolerance;
    s->from_rest = motion_count == 0 && real_tpIsDone(the_tp);
    copy_pose(s->from, &goal);
    copy_pose(s->to, &c->end);
    s->centre[0] = c->centre.x, s->centre[1] = c->centre.y, s->centre[2] = c->centre.z;
    s->normal[0] = c->normal.x, s->normal[1] = c->normal.y, s->normal[2] = c->normal.z;

    if (s->from_rest) was_state_known = find_state(&state_of_queued);
    s->tool_length = status ? status->tool_offset.tran.z : 0.0;
    EmcPose const aside = pose_aside(&goal, &c->end);
    if (find_joints(&s->joint_from, &goal) && find_joints(&s->joint_aside, &aside)
        && find_joints(&s->joint_to, &c->end))
        s->joints = (uint32_t)settings->numJoints;

    c->id = next_id;
    c->tag.packed_flags &= 0xffffffffUL;
    c->tag.packed_flags |= (unsigned long)(uint32_t)c->number << NUMBER_SHIFT;
    if (shape != FEELER_TAP) goal = c->end; /* a tap ends where it begins */
    ++motion_count;
    accepted = c->number;
    if (c->type == FEELER_PROBE && status)
        is_probe_new = 1;
    else
        feeler_store(&ring->written, accepted);
    return TP_ERR_OK;
}

/* Whether a motion cannot be accepted: while an abort brakes, as in the planner, and once after the
 * planner has refused a motion that was accepted, so that the program ends there. */
static int is_closed(void) {
    int const closed = is_aborting || was_refused;
    was_refused = 0;
    return closed;
}

int tpAddLine(TP_STRUCT *const tp, EmcPose end, int type, double vel, double max_vel, double acc,
              unsigned char enables, char at_speed, int index, struct state_tag_t tag) {
    (void)tp;
    if (is_closed()) return TP_ERR_FAIL;
    if (is_same_pose(&goal, &end)) return TP_ERR_ZERO_LENGTH;
    struct call *c = new_call(ADD_LINE);
    if (!c) return TP_ERR_FAIL;
    c->end = end, c->type = type, c->vel = vel, c->max_vel = max_vel, c->acc = acc;
    c->enables = enables, c->at_speed = at_speed, c->index = index, c->tag = tag;
    return accept_motion(c, FEELER_LINE);
}

int tpAddCircle(TP_STRUCT *const tp, EmcPose end, PmCartesian centre, PmCartesian normal, int turn,
                int type, double vel, double max_vel, double acc, unsigned char enables,
                char at_speed, struct state_tag_t tag) {
    (void)tp;
    if (is_closed()) return TP_ERR_FAIL;
    struct call *c = new_call(ADD_CIRCLE);
    if (!c) return TP_ERR_FAIL;
    c->end = end, c->centre = centre, c->normal = normal, c->turn = turn, c->type = type;
    c->vel = vel, c->max_vel = max_vel, c->acc = acc;
    c->enables = enables, c->at_speed = at_speed, c->tag = tag;
    return accept_motion(c, FEELER_ARC);
}

int tpAddRigidTap(TP_STRUCT *const tp, EmcPose end, double vel, double max_vel, double acc,
                  unsigned char enables, double scale, struct state_tag_t tag) {
    (void)tp;
    if (is_closed()) return TP_ERR_FAIL;
    struct call *c = new_call(ADD_TAP);
    if (!c) return TP_ERR_FAIL;
    c->end = end, c->vel = vel, c->max_vel = max_vel, c->acc = acc;
    c->enables = enables, c->scale = scale, c->tag = tag;
    return accept_motion(c, FEELER_TAP);
}

/* --- passing on --------------------------------------------------------------------------------*/

/* Whether the first motion that waits is followed by an arc, as far as is known. */
static int is_before_arc(void) {
    for (unsigned i = 1; i < call_count; ++i)
        if (is_motion(call_at(i))) return call_at(i)->what == ADD_CIRCLE;
    return 0;
}

/* Whether some of the last motion that the planner has was made. */
static int has_last_begun(TC_QUEUE_STRUCT const *queue) {
    if (queue->_len == 0) return 0;
    return queue->queue[(queue->end - 1 + queue->size) % queue->size].progress > 0.0;
}

/* LinuxCNC 2.9 may replace a short line by an arc between its neighbours even if it has begun, and then
 * all that follows is displaced by what was made of it. Such a line is blended without an arc. */
static int pass_on_line(TP_STRUCT *tp, struct call const *c) {
    int const makes_arcs = settings ? settings->arcBlendEnable : 0;
    if (settings && has_last_begun(&tp->queue)) settings->arcBlendEnable = 0;
    int const result = real_tpAddLine(tp, c->end, c->type, c->vel, c->max_vel, c->acc, c->enables,
                                      c->at_speed, c->index, c->tag);
    if (settings) settings->arcBlendEnable = makes_arcs;
    return result;
}

/* LinuxCNC 2.9 takes the angle of a corner at an arc from a vector that leans towards its centre, so it
 * may leave the path by many times the tolerance (tests/guard). Corners at arcs are therefore not
 * blended: it goes on without a stop where they are tangential, and stops elsewhere. */
static int pass_on(TP_STRUCT *tp, struct call *c) {
    if (is_motion(c)) {
        c->may_be_round = c->blends && !is_before_arc();
        if (c->may_be_round)
            real_tpSetTermCond(tp, TC_TERM_COND_PARABOLIC, c->tolerance);
        else if (c->blends || c->keeps_path)
            real_tpSetTermCond(tp, TC_TERM_COND_EXACT, c->tolerance);
    }
    switch (c->what) {
    case ADD_LINE:
        return pass_on_line(tp, c);
    case ADD_CIRCLE:
        return real_tpAddCircle(tp, c->end, c->centre, c->normal, c->turn, c->type, c->vel,
                                c->max_vel, c->acc, c->enables, c->at_speed, c->tag);
    case ADD_TAP:
        return real_tpAddRigidTap(tp, c->end, c->vel, c->max_vel, c->acc, c->enables, c->scale,
                                  c->tag);
    case SET_ID:
        return real_tpSetId(tp, c->index);
    case SET_TERM_COND:
        return real_tpSetTermCond(tp, c->type, c->from);
    case SET_SYNC:
        return real_tpSetSpindleSync(tp, c->index, c->from, c->type);
    case SET_AOUT:
        return real_tpSetAout(tp, c->start, c->from, c->to);
    case SET_DOUT:
        return real_tpSetDout(tp, c->index, c->start, c->stop);
    }
    return TP_ERR_FAIL;
}

/* Forgets what waits. The last termination condition still counts. The planner ends a
 * synchronization with its motions when it is aborted. */
static void drop_calls(TP_STRUCT *tp) {
    for (unsigned i = 0; i < call_count; ++i)
        if (call_at(i)->what == SET_TERM_COND || call_at(i)->what == SET_SYNC)
            pass_on(tp, call_at(i));
    if (motion_count > 0) real_tpSetSpindleSync(tp, 0, 0.0, 0);
    call_count = motion_count = 0;
    was_dropped = 1;
    show_probe();
    feeler_store(&ring->dropped, accepted);
}

/* Stops, and lets LinuxCNC end the program, whose next motion would start elsewhere. */
static void end_program(TP_STRUCT *tp) {
    tpAbort(tp);
    was_refused = 1;
    if (status) status->motionFlag |= EMCMOT_MOTION_ERROR_BIT;
}

/* What was queued would be made elsewhere. */
static void end_program_at_change(TP_STRUCT *tp) {
    end_program(tp);
    feeler_store(&ring->ended, ring->ended + 1);
}

/* The planner refused a motion that was accepted. What follows would start elsewhere. */
static void fail(TP_STRUCT *tp, struct call const *c, int code) {
    rtapi_print_msg(RTAPI_MSG_ERR, "feeler_tp: the planner refuses the motion of line %d (code %d)\n",
                    c->tag.fields[GM_FIELD_LINE_NUMBER], code);
    end_program(tp);
}

/* The last motion that the planner may have. */
static uint64_t last_permitted(void) {
    uint64_t const permit = feeler_load(&ring->permitted);
    uint64_t const permitted = feeler_permitted_number(permit);
    /* Permits of another session, or for motions that do not exist, are none. */
    int const is_valid = permit == feeler_permit(ring->session, permitted)
                         && permitted <= accepted && !has_external_offset();
    return is_valid ? permitted : 0;
}

static void release_permitted(TP_STRUCT *tp) {
    uint64_t const permitted = last_permitted();
    feeler_store(&ring->external, (uint64_t)has_external_offset());
    int motions = 0;
    while (call_count > 0 && motions < 8 && !real_tcqFull(&tp->queue)) {
        struct call *c = call_at(0);
        if (is_motion(c) && c->number > permitted) return;
        if (is_motion(c) && must_rest_before(c, &last_passed) && !real_tpIsDone(tp)) return;
        int const result = pass_on(tp, c);
        if (is_motion(c)) {
            /* 0: queued. Positive: the planner found no length in it. */
            if (result < 0) {
                fail(tp, c, result);
                return;
            }
            ++motions;
            --motion_count;
            if (result == 0) last_passed = *c;
            was_stopped = 0;
            feeler_store(&ring->released, c->number);
        }
        first_call = (first_call + 1) % CALLS;
        --call_count;
    }
}

/* Says once that the guard has ended while the machine still makes what it has permitted. */
static void say_what_still_moves(TP_STRUCT *tp, long long now) {
    if (*pins->guard_alive || ring->alive == 0) {
        has_said_end = 0;
    } else if (!has_said_end && now - alive_at > 2 * second && !real_tpIsDone(tp)) {
        has_said_end = 1;
        rtapi_print_msg(RTAPI_MSG_ERR, "Feeler: feeler guard has ended or does not answer. The machine makes what it has permitted, and then stops\n");
    }
}

/* Says once that motions wait because no guard answers. */
static void say_why_nothing_moves(long long now) {
    if (!*pins->holding || *pins->guard_alive) {
        waits_since = now;
        has_said_why = 0;
    } else if (!has_said_why && now - waits_since > second) {
        has_said_why = 1;
        rtapi_print_msg(RTAPI_MSG_ERR, "Feeler holds: feeler guard does not run or does not answer, so nothing moves\n");
    }
}

static void show_state(TP_STRUCT *tp) {
    uint64_t const alive = feeler_load(&ring->alive);
    long long const now = rtapi_get_time();
    if (alive != last_alive) alive_at = now;
    last_alive = alive;
    *pins->guard_alive = alive != 0 && now - alive_at < second;
    *pins->latched = feeler_load(&ring->latched) != 0;
    *pins->holding =
        motion_count > 0 && real_tpIsDone(tp) && first_motion()->number > last_permitted();
    say_what_still_moves(tp, now);
    say_why_nothing_moves(now);
    if (motion_count > 0) *pins->line = first_motion()->tag.fields[GM_FIELD_LINE_NUMBER];
    if (*pins->clear && !was_clear_pressed) feeler_store(&ring->cleared, ring->cleared + 1);
    was_clear_pressed = *pins->clear;
}

int tpRunCycle(TP_STRUCT *const tp, long period) {
    show_probe();
    int const has_motions = motion_count > 0 || !real_tpIsDone(tp);
    if (has_motions && !is_aborting && have_kinematics_changed()) end_program_at_change(tp);
    if (!is_aborting) release_permitted(tp);
    int const was_busy = !real_tpIsDone(tp);
    if (was_busy && !is_aborting && has_external_offset()) end_program_at_change(tp);
    if (is_pausing && !is_aborting) real_tpPause(tp);
    uint64_t const before = executing(tp);
    int const result = real_tpRunCycle(tp, period);
    int const is_busy = !real_tpIsDone(tp);
    /* The planner ends a pause when it has no motion left; here some may wait. */
    if (!is_busy && motion_count == 0) is_pausing = 0;
    if (is_aborting && !is_busy) {
        is_aborting = is_pausing = 0;
        note_stop(tp, was_busy, before);
    }
    uint64_t const now = executing(tp);
    feeler_store(&ring->busy, (uint64_t)is_busy);
    if (now) {
        last_begun = now;
        /* The motion before the present one may still end in a blend. */
        if (now > 2 && now - 2 > ring->made) feeler_store(&ring->made, now - 2);
    } else if (!is_busy && ring->released != released_at_stop) {
        last_begun = ring->released;
        feeler_store(&ring->made, ring->released);
    }
    return result;
}

/* --- settings between motions ------------------------------------------------------------------*/

int tpSetId(TP_STRUCT *const tp, int id) {
    next_id = id;
    if (call_count == 0) return real_tpSetId(tp, id);
    struct call *c = new_call(SET_ID);
    if (!c) return TP_ERR_FAIL;
    c->index = id;
    return TP_ERR_OK;
}

int tpSetTermCond(TP_STRUCT *const tp, int cond, double tol) {
    term_cond = cond;
    tolerance = cond == TC_TERM_COND_PARABOLIC && tol > 0 ? tol : 0;
    if (call_count == 0) return real_tpSetTermCond(tp, cond, tol);
    struct call *c = new_call(SET_TERM_COND);
    if (!c) return TP_ERR_FAIL;
    c->type = cond, c->from = tol;
    return TP_ERR_OK;
}

int tpSetSpindleSync(TP_STRUCT *const tp, int spindle, double sync, int wait) {
    if (call_count == 0) return real_tpSetSpindleSync(tp, spindle, sync, wait);
    struct call *c = new_call(SET_SYNC);
    if (!c) return TP_ERR_FAIL;
    c->index = spindle, c->from = sync, c->type = wait;
    return TP_ERR_OK;
}

int tpSetAout(TP_STRUCT *const tp, unsigned char index, double start, double end) {
    if (call_count == 0) return real_tpSetAout(tp, index, start, end);
    struct call *c = new_call(SET_AOUT);
    if (!c) return TP_ERR_FAIL;
    c->start = index, c->from = start, c->to = end;
    return TP_ERR_OK;
}

int tpSetDout(TP_STRUCT *const tp, int index, unsigned char start, unsigned char end) {
    if (call_count == 0) return real_tpSetDout(tp, index, start, end);
    struct call *c = new_call(SET_DOUT);
    if (!c) return TP_ERR_FAIL;
    c->index = index, c->start = start, c->stop = end;
    return TP_ERR_OK;
}

/* --- the rest ----------------------------------------------------------------------------------*/

int tpCreate(TP_STRUCT *const tp, int size, int id) {
    if (the_tp) return TP_ERR_FAIL;
    the_tp = tp;
    return real_tpCreate(tp, size, id);
}

int tpClear(TP_STRUCT *const tp) {
    drop_calls(tp);
    int const was_busy = !real_tpIsDone(tp);
    uint64_t const before = executing(tp);
    int const result = real_tpClear(tp);
    is_aborting = is_pausing = was_refused = 0;
    term_cond = TC_TERM_COND_PARABOLIC;
    tolerance = 0;
    note_stop(tp, was_busy, before);
    feeler_store(&ring->busy, 0);
    return result;
}

int tpAbort(TP_STRUCT *const tp) {
    drop_calls(tp);
    is_aborting = 1;
    was_refused = 0; /* the operator's abort ends the program, too */
    return real_tpAbort(tp);
}

int tpSetPos(TP_STRUCT *const tp, EmcPose const *const pos) {
    /* As after a change of the kinematics. */
    if (motion_count > 0 || !real_tpIsDone(tp))
        end_program_at_change(tp);
    else if (call_count > 0)
        drop_calls(tp);
    goal = *pos;
    return real_tpSetPos(tp, pos);
}

/* Backwards nothing has been permitted. */
int tpSetRunDir(TP_STRUCT *const tp, tc_direction_t direction) {
    return direction == TC_DIR_FORWARD ? real_tpSetRunDir(tp, direction) : TP_ERR_FAIL;
}

int tpIsDone(TP_STRUCT *const tp) { return motion_count == 0 && real_tpIsDone(tp); }

int tpQueueDepth(TP_STRUCT *const tp) { return real_tpQueueDepth(tp) + (int)motion_count; }

/* LinuxCNC asks for this once in every cycle, in every mode. */
int tpActiveDepth(TP_STRUCT *const tp) {
    show_state(tp);
    return real_tpActiveDepth(tp);
}

/* The first motion that waits, if the planner has none. */
static struct call *waiting_motion(TP_STRUCT *tp) {
    return motion_count > 0 && real_tpIsDone(tp) ? first_motion() : NULL;
}

int tpGetExecId(TP_STRUCT *const tp) {
    struct call *c = waiting_motion(tp);
    return c ? c->id : real_tpGetExecId(tp);
}

struct state_tag_t tpGetExecTag(TP_STRUCT *const tp) {
    struct call *c = waiting_motion(tp);
    struct state_tag_t tag = c ? c->tag : real_tpGetExecTag(tp);
    tag.packed_flags &= 0xffffffffUL;
    return tag;
}

int tcqFull(TC_QUEUE_STRUCT const *const queue) { return is_full() || real_tcqFull(queue); }

int tpSetCycleTime(TP_STRUCT *tp, double secs) { return real_tpSetCycleTime(tp, secs); }
int tpSetVmax(TP_STRUCT *tp, double vmax, double most) { return real_tpSetVmax(tp, vmax, most); }
int tpSetVlimit(TP_STRUCT *tp, double limit) { return real_tpSetVlimit(tp, limit); }
int tpSetAmax(TP_STRUCT *tp, double amax) { return real_tpSetAmax(tp, amax); }
int tpPause(TP_STRUCT *tp) {
    is_pausing = 1;
    return real_tpPause(tp);
}
int tpResume(TP_STRUCT *tp) {
    is_pausing = 0;
    return real_tpResume(tp);
}
int tpGetPos(TP_STRUCT const *const tp, EmcPose *const pos) { return real_tpGetPos(tp, pos); }
int tpGetMotionType(TP_STRUCT *const tp) { return real_tpGetMotionType(tp); }

void tpMotFunctions(void (*dio)(int, char), void (*aio)(int, double), void (*unlock)(int, int),
                    int (*is_unlocked)(int), double (*vel_limit)(int), double (*acc_limit)(int)) {
    real_tpMotFunctions(dio, aio, unlock, is_unlocked, vel_limit, acc_limit);
}

void tpMotData(emcmot_status_t *motion_status, emcmot_config_t *motion_config) {
    status = motion_status;
    settings = motion_config;
    /* motmod, which calls this, was loaded after the kinematics that it needs. */
    *(void **)&kinematics = dlsym(RTLD_DEFAULT, "kinematicsInverse");
    real_tpMotData(motion_status, motion_config);
}

#define EXPORT(result, name, arguments) EXPORT_SYMBOL(name);
PLANNER(EXPORT)

/* --- loading -----------------------------------------------------------------------------------*/

/* Opens the stock planner: in the folder of this module, or where Debian's package has it. */
static int open_planner(void) {
    char path[1024] = "";
    Dl_info self;
    if (dladdr((void *)&open_planner, &self) && self.dli_fname
        && strlen(self.dli_fname) + 16 < sizeof path)
        strcpy(path, self.dli_fname);
    char *const slash = strrchr(path, '/');
    strcpy(slash ? slash + 1 : path, "tpmod.so");
    /* Its own calls must find itself, not this module, which has the same names. */
    int const how = RTLD_NOW | RTLD_LOCAL | RTLD_DEEPBIND;
    planner = slash ? dlopen(path, how) : NULL;
    if (!planner) planner = dlopen("/usr/lib/linuxcnc/modules/tpmod.so", how);
    if (!planner) {
        rtapi_print_msg(RTAPI_MSG_ERR, "feeler_tp: %s\n", dlerror());
        return -1;
    }
#define FIND(result, name, arguments)                                                             \
    *(void **)&real_##name = dlsym(planner, #name);                                                \
    if (!real_##name) {                                                                            \
        rtapi_print_msg(RTAPI_MSG_ERR, "feeler_tp: this tpmod has no " #name                        \
                                       "; its version of LinuxCNC is not known\n");                \
        return -1;                                                                                 \
    }
    PLANNER(FIND)
    return 0;
}

/* Whether the planner's struct is laid out as in the headers with which this module was built:
 * functions are called on a struct of zeros, and their effects must be where they are expected. */
static int has_known_layout(void) {
    static union {
        TP_STRUCT tp;
        char room[sizeof(TP_STRUCT) + 4096];
    } trial;
    memset(&trial, 0, sizeof trial);
    EmcPose pose, back;
    memset(&pose, 0, sizeof pose);
    pose.tran.x = 1.5, pose.tran.z = -2.25, pose.w = 7.0;
    real_tpSetPos(&trial.tp, &pose);
    real_tpSetTermCond(&trial.tp, TC_TERM_COND_PARABOLIC, 0.625);
    real_tpSetId(&trial.tp, 4711);
    real_tpPause(&trial.tp);
    real_tpSetVlimit(&trial.tp, 12.5);
    if (real_tpGetPos(&trial.tp, &back) != 0 || !is_same_pose(&pose, &back)) return 0;
    int known = is_same_pose(&trial.tp.currentPos, &pose) && is_same_pose(&trial.tp.goalPos, &pose)
                && trial.tp.termCond == TC_TERM_COND_PARABOLIC && trial.tp.tolerance == 0.625
                && trial.tp.nextId == 4711 && trial.tp.pausing == 1 && trial.tp.vLimit == 12.5;
    trial.tp.execTag.packed_flags = 0x123456789abcdefUL;
    trial.tp.execTag.fields[GM_FIELD_LINE_NUMBER] = 815;
    struct state_tag_t const tag = real_tpGetExecTag(&trial.tp);
    known = known && tag.packed_flags == trial.tp.execTag.packed_flags
            && tag.fields[GM_FIELD_LINE_NUMBER] == 815;
    for (size_t i = sizeof(TP_STRUCT); i < sizeof trial.room; ++i)
        known = known && trial.room[i] == 0;
    return known;
}

static int make_pins(void) {
    pins = hal_malloc(sizeof *pins);
    if (!pins) return -1;
    int r = hal_pin_s32_newf(HAL_IN, &pins->tool_number, component, "feeler-tp.tool-number");
    r |= hal_pin_bit_newf(HAL_IN, &pins->clear, component, "feeler-tp.clear");
    r |= hal_pin_bit_newf(HAL_OUT, &pins->holding, component, "feeler-tp.holding");
    r |= hal_pin_bit_newf(HAL_OUT, &pins->guard_alive, component, "feeler-tp.guard-alive");
    r |= hal_pin_bit_newf(HAL_OUT, &pins->latched, component, "feeler-tp.latched");
    r |= hal_pin_s32_newf(HAL_OUT, &pins->line, component, "feeler-tp.line");
    if (r) return -1;
    *pins->tool_number = -1; /* as long as nothing is connected */
    return 0;
}

static int make_ring(void) {
    void *address = NULL;
    memory = rtapi_shmem_new(FEELER_RING_KEY, component, sizeof *ring);
    if (memory < 0 || rtapi_shmem_getptr(memory, &address) < 0) return -1;
    ring = address;
    memset(ring, 0, sizeof *ring);
    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    ring->session = ((uint64_t)now.tv_sec * 1000u + (uint64_t)now.tv_nsec / 1000000u) & 0xffff;
    ring->bytes = sizeof *ring;
    ring->segments = FEELER_RING_SEGMENTS;
    ring->version = FEELER_RING_VERSION;
    __atomic_store_n(&ring->magic, FEELER_RING_MAGIC, __ATOMIC_RELEASE);
    return 0;
}

int rtapi_app_main(void) {
    component = hal_init("feeler_tp");
    if (component < 0) return component;
    if (open_planner() < 0) {
        hal_exit(component);
        return -1;
    }
    if (!has_known_layout()) {
        rtapi_print_msg(RTAPI_MSG_ERR, "feeler_tp: this tpmod is not the one of the headers with "
                                       "which feeler_tp was built; build it again\n");
        hal_exit(component);
        return -1;
    }
    if (make_pins() < 0 || make_ring() < 0) {
        rtapi_print_msg(RTAPI_MSG_ERR, "feeler_tp: no memory for pins or the ring\n");
        hal_exit(component);
        return -1;
    }
    hal_ready(component);
    return 0;
}

void rtapi_app_exit(void) {
    if (ring) ring->magic = 0;
    if (memory >= 0) rtapi_shmem_delete(memory, component);
    hal_exit(component);
}
