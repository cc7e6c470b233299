/* Tests feeler_tp with the real planner of LinuxCNC (tpmod.so), without the rest of LinuxCNC: what
 * motmod calls in each servo cycle is called here. */
#include "assets/linuxcnc/feeler_tp/feeler_tp.c"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* --- what LinuxCNC's HAL and RTAPI would do ----------------------------------------------------*/

void rtapi_print_msg(msg_level_t level, char const *format, ...) {
    (void)level;
    (void)format;
}
void rtapi_print(char const *format, ...) { (void)format; }
long long rtapi_get_time(void) { return 0; }
int hal_init(char const *name) {
    (void)name;
    return 1;
}
int hal_exit(int id) {
    (void)id;
    return 0;
}
int hal_ready(int id) {
    (void)id;
    return 0;
}
void *hal_malloc(long size) { return calloc(1, (size_t)size); }
int hal_pin_s32_newf(hal_pin_dir_t direction, hal_s32_t **pin, int id, char const *format, ...) {
    (void)direction, (void)id, (void)format;
    *pin = calloc(1, 8);
    return 0;
}
int hal_pin_bit_newf(hal_pin_dir_t direction, hal_bit_t **pin, int id, char const *format, ...) {
    (void)direction, (void)id, (void)format;
    *pin = calloc(1, 8);
    return 0;
}
static void *shared;
int rtapi_shmem_new(int key, int id, unsigned long size) {
    (void)key, (void)id;
    shared = calloc(1, size);
    return 1;
}
int rtapi_shmem_getptr(int id, void **address) {
    (void)id;
    *address = shared;
    return 0;
}
int rtapi_shmem_delete(int id, int module) {
    (void)id, (void)module;
    return 0;
}

/* A machine whose joints are 1000 from the planner's positions; in its other mode 2000. */
static double joint_offset = 1000.0;
static int has_inverse = 1;
int kinematicsInverse(EmcPose const *pose, double *joint, KINEMATICS_INVERSE_FLAGS const *inverse,
                      KINEMATICS_FORWARD_FLAGS *forward) {
    (void)inverse, (void)forward;
    joint[0] = pose->tran.x + joint_offset;
    joint[1] = pose->tran.y + joint_offset;
    joint[2] = pose->tran.z + joint_offset;
    return has_inverse ? 0 : -1;
}

static int output_line; /* in which digital output 0 was set last */
static struct state_tag_t tag;
static TP_STRUCT tp;
static emcmot_status_t motion;
static emcmot_config_t config;

static void set_output(int index, char value) {
    (void)index, (void)value;
    output_line = real_tpGetExecTag(&tp).fields[GM_FIELD_LINE_NUMBER];
}
static void set_analog(int index, double value) { (void)index, (void)value; }
static void unlock(int axis, int is_unlocked) { (void)axis, (void)is_unlocked; }
static int is_unlocked(int axis) {
    (void)axis;
    return 1;
}
static double axis_speed[3] = {100, 100, 100}, axis_acceleration[3] = {1000, 1000, 1000};
static double velocity_limit(int axis) { return axis < 3 ? axis_speed[axis] : 100.0; }
static double acceleration_limit(int axis) { return axis < 3 ? axis_acceleration[axis] : 1000.0; }

/* --- helpers -----------------------------------------------------------------------------------*/

static int failures;
static void expect(int condition, char const *what, int line) {
    if (condition) return;
    ++failures;
    printf("line %d: %s\n", line, what);
}
#define EXPECT(condition) expect((condition), #condition, __LINE__)

static void cycle(int count) {
    while (count-- > 0) {
        tpRunCycle(&tp, 1000000);
        tpQueueDepth(&tp);
        tpActiveDepth(&tp);
        motion.id = tpGetExecId(&tp);
    }
}

static EmcPose at(double x, double y, double z) {
    EmcPose pose;
    memset(&pose, 0, sizeof pose);
    pose.tran.x = x, pose.tran.y = y, pose.tran.z = z;
    return pose;
}

static int line_number;
static int add_line(double x, double y, double z) {
    tpSetId(&tp, ++line_number);
    tag.fields[GM_FIELD_LINE_NUMBER] = line_number;
    return tpAddLine(&tp, at(x, y, z), 2, 50.0, 100.0, 1000.0, 0xff, 0, -1, tag);
}
static int add_line_at_speed(double x) {
    tpSetId(&tp, ++line_number);
    tag.fields[GM_FIELD_LINE_NUMBER] = line_number;
    return tpAddLine(&tp, at(x, 0, 0), 2, 50.0, 100.0, 1000.0, 0xff, 1, -1, tag);
}
static int add_tap(double z) {
    tpSetId(&tp, ++line_number);
    return tpAddRigidTap(&tp, at(0, 0, z), 10.0, 20.0, 1000.0, 0xff, 1.0, tag);
}

/* Plays the guard, which has read everything. */
static void permit(uint64_t number) {
    feeler_store(&ring->read, ring->written);
    feeler_store(&ring->permitted, feeler_permit(ring->session, number));
}

static double x_of(void) {
    EmcPose pose;
    tpGetPos(&tp, &pose);
    return pose.tran.x;
}
static struct feeler_segment const *last_segment(void) {
    return &ring->segment[ring->written % FEELER_RING_SEGMENTS];
}

static void start(void) {
    EXPECT(rtapi_app_main() == 0);
    config.numSpindles = 1;
    config.numJoints = 3;
    config.numDIO = config.numAIO = 4;
    config.maxFeedScale = 1.2;
    config.arcBlendEnable = config.arcBlendFallbackEnable = 1;
    config.arcBlendOptDepth = 50;
    config.arcBlendGapCycles = 4;
    config.arcBlendRampFreq = 100;
    config.arcBlendTangentKinkRatio = 0.1;
    motion.net_feed_scale = 1.0;
    motion.spindle_status[0].at_speed = 1;
    motion.spindle_status[0].net_scale = 1.0;
    tpMotFunctions(set_output, set_analog, unlock, is_unlocked, velocity_limit,
                   acceleration_limit);
    tpMotData(&motion, &config);
    EXPECT(tpCreate(&tp, DEFAULT_TC_QUEUE_SIZE, 1) == 0);
    tpSetCycleTime(&tp, 0.001);
    tpSetVmax(&tp, 100.0, 100.0);
    tpSetVlimit(&tp, 100.0);
    tpSetAmax(&tp, 1000.0);
    EmcPose const origin = at(0, 0, 0);
    tpSetPos(&tp, &origin);
    cycle(3);
}

/* --- cases -------------------------------------------------------------------------------------*/

static void moves_only_as_far_as_permitted(void) {
    for (int i = 1; i <= 20; ++i) EXPECT(add_line(10.0 * i, 0, 0) == TP_ERR_OK);
    cycle(500);
    EXPECT(x_of() == 0.0 && !tpIsDone(&tp) && tpQueueDepth(&tp) == 20);
    EXPECT(*pins->holding && *pins->line == 1);
    for (uint64_t number = 1; number <= 20; number += 3) {
        permit(number);
        cycle(3000);
        EXPECT(fabs(x_of() - 10.0 * (double)number) < 1e-9);
        EXPECT(ring->made == number);
    }
    permit(21); /* a motion that does not exist */
    cycle(3000);
    EXPECT(ring->released == 19);
    permit(20);
    cycle(3000);
    EXPECT(fabs(x_of() - 200.0) < 1e-9 && tpIsDone(&tp) && !*pins->holding);
}

/* Never beyond what is permitted, in any cycle, at any speed and with any blending. */
static void never_passes_the_permit(void) {
    srand(1);
    tpSetTermCond(&tp, TC_TERM_COND_PARABOLIC, 0.0);
    double end[400] = {0};
    uint64_t permitted = 0;
    for (int i = 1; i < 400; ++i) {
        end[i] = end[i - 1] + 0.05 + rand() % 100 / 20.0;
        EXPECT(add_line(end[i], rand() % 3, 0) == TP_ERR_OK);
        motion.net_feed_scale = 0.2 + rand() % 100 / 100.0;
        for (int j = rand() % 30; j > 0; --j) {
            cycle(1);
            EXPECT(x_of() <= end[permitted] + 1e-9);
        }
        if (rand() % 3 == 0) {
            permitted = (uint64_t)(permitted + 1 + (uint64_t)rand() % ((uint64_t)i - permitted + 1));
            if (permitted > (uint64_t)i) permitted = (uint64_t)i;
            permit(permitted);
        }
    }
    motion.net_feed_scale = 1.0;
    permit(399);
    for (int i = 0; i < 200000 && !tpIsDone(&tp); ++i) cycle(1);
    EXPECT(tpIsDone(&tp) && ring->made == 399);
}

static void ignores_permits_of_another_session(void) {
    add_line(10, 0, 0);
    feeler_store(&ring->permitted, feeler_permit(ring->session ^ 1, 1));
    cycle(500);
    EXPECT(x_of() == 0.0);
    permit(1);
    cycle(3000);
    EXPECT(x_of() == 10.0);
}

static void tells_where_an_abort_ended_a_motion(void) {
    add_line(10, 0, 0);
    add_line(100, 0, 0);
    add_line(100, 50, 0);
    permit(3);
    while (x_of() < 40.0) cycle(1);
    tpAbort(&tp);
    cycle(500);
    EXPECT(tpIsDone(&tp) && ring->made < 2 && ring->dropped == 3);
    double const stopped = x_of();
    add_line(20, 0, 0);
    EXPECT(last_segment()->follows == 2 && last_segment()->follows_part);
    EXPECT(last_segment()->stopped_at[0] == stopped && last_segment()->from[0] == stopped);
    /* Dropped before the guard has read it, so the next one must say the same. */
    tpAbort(&tp);
    cycle(10);
    add_line(30, 0, 0);
    EXPECT(last_segment()->follows == 2 && last_segment()->follows_part);
    permit(5);
    cycle(3000);
    EXPECT(x_of() == 30.0 && ring->made == 5);
    add_line(40, 0, 0);
    EXPECT(last_segment()->follows == 5 && !last_segment()->follows_part);
}

/* A motion that waits for the spindle has not begun, though the planner has it. */
static void counts_nothing_that_waits_for_the_spindle(void) {
    add_line(10, 0, 0);
    permit(1);
    cycle(3000);
    tpClear(&tp);
    EmcPose const here = at(10, 0, 0);
    tpSetPos(&tp, &here);
    motion.spindle_status[0].at_speed = 0;
    add_line_at_speed(60);
    permit(2);
    cycle(100);
    EXPECT(ring->made == 1 && x_of() == 10.0);
    tpAbort(&tp);
    cycle(10);
    add_line(20, 0, 0);
    EXPECT(ring->made == 1 && last_segment()->follows == 1);
}

static void counts_no_thread_that_was_aborted(void) {
    tpSetSpindleSync(&tp, 0, 1.0, 0);
    add_line(0, 0, -20);
    tpSetSpindleSync(&tp, 0, 0, 0);
    permit(1);
    cycle(2);
    motion.spindle_status[0].spindle_index_enable = 0;
    motion.spindle_status[0].direction = 1;
    for (int i = 0; i < 500; ++i) {
        motion.spindle_status[0].spindleRevs += 0.01;
        cycle(1);
    }
    tpAbort(&tp);
    cycle(500);
    add_line(10, 0, 0);
    EXPECT(ring->made == 0 && last_segment()->follows == 0);
}

static void counts_no_motion_that_the_planner_refuses(void) {
    EXPECT(add_tap(-10) == TP_ERR_OK); /* not synchronized: refused */
    permit(1);
    cycle(5);
    EXPECT(ring->made == 0 && tpIsDone(&tp));
    EXPECT(add_line(10, 0, 0) == TP_ERR_FAIL); /* so that LinuxCNC ends the program */
    tpAbort(&tp);
    cycle(5);
    EXPECT(add_line(10, 0, 0) == TP_ERR_OK);
    EXPECT(last_segment()->follows == 0);
    permit(ring->written);
    cycle(3000);
    EXPECT(x_of() == 10.0);
    EXPECT(ring->ended == 0); /* that is another matter */
}

static void keeps_a_pause_while_motions_wait(void) {
    add_line(10, 0, 0);
    add_line(20, 0, 0);
    permit(1);
    cycle(3000);
    tpPause(&tp);
    cycle(10);
    permit(2);
    cycle(500);
    EXPECT(x_of() == 10.0);
    tpResume(&tp);
    cycle(3000);
    EXPECT(x_of() == 20.0);
}

static void refuses_motions_while_an_abort_brakes(void) {
    add_line(100, 0, 0);
    permit(1);
    cycle(200);
    tpAbort(&tp);
    EXPECT(add_line(100, 10, 0) == TP_ERR_FAIL);
    cycle(500);
    EXPECT(add_line(0, 0, 0) == TP_ERR_OK);
}

static void ends_synchronization_with_an_abort(void) {
    tpSetSpindleSync(&tp, 0, 1.0, 0);
    add_line(0, 0, -20);
    tpSetSpindleSync(&tp, 0, 0, 0);
    cycle(10);
    tpAbort(&tp);
    cycle(10);
    add_line(10, 0, 0);
    permit(ring->written);
    cycle(3000);
    EXPECT(x_of() == 10.0);

    tpSetSpindleSync(&tp, 0, 1.0, 0); /* aborted before it is switched off */
    add_line(10, 0, -20);
    tpAbort(&tp);
    cycle(10);
    EXPECT(!tp.synchronized);
}

static void stops_at_external_offsets(void) {
    add_line(100, 0, 0);
    add_line(200, 0, 0);
    permit(2);
    while (x_of() < 20.0) cycle(1);
    motion.eoffset_pose.tran.z = -5.0;
    cycle(500);
    EXPECT(tpIsDone(&tp) && x_of() < 30.0 && ring->external == 1);
    EXPECT(add_line(200, 10, 0) == TP_ERR_FAIL); /* so that LinuxCNC ends the program */
    tpAbort(&tp);
    cycle(5);
    add_line(0, 0, 0);
    permit(ring->written);
    cycle(500);
    EXPECT(x_of() > 10.0);
    motion.eoffset_pose.tran.z = 0.0;
    cycle(3000);
    EXPECT(x_of() == 0.0);
}

static void keeps_outputs_with_their_motions(void) {
    add_line(10, 0, 0);
    tpSetDout(&tp, 0, 1, 0);
    add_line(20, 0, 0);
    add_line(30, 0, 0);
    permit(1);
    cycle(3000);
    EXPECT(output_line == 0);
    permit(3);
    cycle(3000);
    EXPECT(output_line == 2);
}

static void keeps_path_modes_with_their_motions(void) {
    add_line(10, 0, 0);
    tpSetTermCond(&tp, TC_TERM_COND_STOP, 0.0);
    add_line(20, 0, 0);
    EXPECT(last_segment()->blending == FEELER_EXACT_STOP);
    tpSetTermCond(&tp, TC_TERM_COND_PARABOLIC, 0.25);
    add_line(30, 0, 0);
    EXPECT(last_segment()->blending == FEELER_BLENDED && last_segment()->tolerance == 0.25);
    cycle(10);
    EXPECT(tp.termCond == TC_TERM_COND_PARABOLIC && tp.tolerance == 0.0);
    permit(2);
    cycle(1);
    EXPECT(tp.termCond == TC_TERM_COND_PARABOLIC && tp.tolerance == 0.25);
    tpSetTermCond(&tp, TC_TERM_COND_EXACT, 0.0);
    tpAbort(&tp); /* the mode stays, as it does in the planner */
    cycle(500);
    EXPECT(tp.termCond == TC_TERM_COND_EXACT);
}

/* While a motion is made, the one before it may still end in a blend. */
static void counts_a_motion_once_the_next_one_is_over(void) {
    tpSetTermCond(&tp, TC_TERM_COND_PARABOLIC, 0.0);
    for (int i = 1; i <= 4; ++i) add_line(10.0 * i, i % 2, 0);
    permit(4);
    for (int i = 0; i < 20000 && !tpIsDone(&tp); ++i) {
        cycle(1);
        uint64_t const completed = (uint64_t)(x_of() / 10.0 + 1e-9);
        EXPECT(ring->made <= completed);
        EXPECT(tpGetExecTag(&tp).packed_flags >> 32 == 0);
    }
    EXPECT(ring->made == 4);
}

static void begins_the_motion_after_a_tap_where_that_began(void) {
    tpSetSpindleSync(&tp, 0, 1.0, 0);
    EXPECT(add_tap(-10) == TP_ERR_OK);
    tpSetSpindleSync(&tp, 0, 0, 0);
    add_line(10, 0, 0);
    EXPECT(last_segment()->from[2] == 0.0);
}

/* A program without a tolerance gets that of the guard between feeds. */
static void limits_the_rounding_of_feeds(void) {
    ring->feed_tolerance = 0.125;
    add_line(10, 0, 0);
    EXPECT(last_segment()->tolerance == 0.125);
    tpSetId(&tp, ++line_number);
    tpAddLine(&tp, at(20, 0, 0), 1, 50.0, 100.0, 1000.0, 0xff, 0, -1, tag);
    EXPECT(last_segment()->tolerance == 0.0);
    permit(1);
    cycle(1);
    EXPECT(tp.tolerance == 0.125);
    permit(2);
    cycle(1);
    EXPECT(tp.tolerance == 0.0);
    tpSetTermCond(&tp, TC_TERM_COND_PARABOLIC, 0.5);
    add_line(30, 0, 0);
    EXPECT(last_segment()->tolerance == 0.5);
    tpSetTermCond(&tp, TC_TERM_COND_STOP, 0.0);
    add_line(40, 0, 0);
    permit(4);
    cycle(1);
    EXPECT(tp.termCond == TC_TERM_COND_STOP);
}

static void tells_what_begins_at_rest(void) {
    add_line(10, 0, 0);
    EXPECT(last_segment()->from_rest);
    add_line(20, 0, 0);
    EXPECT(!last_segment()->from_rest);
    permit(2);
    while (x_of() < 15.0) cycle(1);
    add_line(30, 0, 0);
    EXPECT(!last_segment()->from_rest);
    permit(3);
    cycle(5000);
    add_line(40, 0, 0);
    EXPECT(last_segment()->from_rest);
}

static void tells_how_the_spindle_turns(void) {
    motion.spindle_status[0].direction = -1;
    motion.spindle_status[0].speed = -500.0;
    add_line(10, 0, 0);
    EXPECT(last_segment()->turns_on == 2 && last_segment()->speed == 500.0);
    motion.spindle_status[0].direction = 0;
    add_line(20, 0, 0);
    EXPECT(last_segment()->turns_on == 0);
    motion.spindle_status[0].direction = 1; /* by hand, without a speed */
    motion.spindle_status[0].speed = 0.0;
    add_line(30, 0, 0);
    EXPECT(last_segment()->turns_on == 1);
    motion.spindle_status[0].speed = 800.0;
    motion.spindle_status[0].net_scale = 0.5; /* overridden */
    add_line(40, 0, 0);
    EXPECT(last_segment()->speed == 400.0);
}

/* LinuxCNC says of which kind a probe is only after it was queued. */
static void tells_which_way_a_probe_goes(void) {
    for (int away = 0; away <= 1; ++away) {
        uint64_t const before = ring->written;
        tpSetId(&tp, ++line_number);
        EXPECT(tpAddLine(&tp, at(10 + away, 0, 0), FEELER_PROBE, 5.0, 100.0, 1000.0, 0xff, 0, -1, tag) == 0);
        EXPECT(ring->written == before);
        motion.probe_type = away ? 3 : 1;
        cycle(1);
        EXPECT(ring->written == before + 1);
        EXPECT(last_segment()->purpose == (away ? FEELER_PROBE_AWAY : FEELER_PROBE));
    }
    /* Nothing of it is lost if it is dropped at once. */
    tpSetId(&tp, ++line_number);
    tpAddLine(&tp, at(20, 0, 0), FEELER_PROBE, 5.0, 100.0, 1000.0, 0xff, 0, -1, tag);
    tpAbort(&tp);
    EXPECT(ring->dropped == ring->written && last_segment()->to[0] == 20.0);
}

static void runs_only_forwards(void) {
    EXPECT(tpSetRunDir(&tp, TC_DIR_REVERSE) != TP_ERR_OK);
    EXPECT(tpSetRunDir(&tp, TC_DIR_FORWARD) == TP_ERR_OK);
}

static void is_full_before_the_ring_is(void) {
    int count = 0;
    while (!tcqFull(&tp.queue) && count < 10000) {
        EXPECT(add_line(++count, 0, 0) == TP_ERR_OK);
        cycle(1);
    }
    EXPECT(count > 1000 && count < (int)FEELER_RING_SEGMENTS);
    for (int i = 0; i < 10000; ++i) {
        if (i % 50 == 0) {
            tpAbort(&tp);
            cycle(5);
        }
        add_line(count + 2.0 + i, 0, 0);
    }
    EXPECT(ring->written <= FEELER_RING_SEGMENTS); /* nothing was read */
    EXPECT(add_line(-5, 0, 0) == TP_ERR_FAIL);
}

/* What the kinematics make of each motion is in the ring. */
static void asks_the_kinematics(void) {
    motion.tool_offset.tran.z = 80.0;
    add_line(10, 20, 0);
    struct feeler_segment const *s = last_segment();
    EXPECT(s->joints == 3 && s->tool_length == 80.0);
    EXPECT(s->joint_from[0] == 1000.0 && s->joint_to[0] == 1010.0 && s->joint_to[1] == 1020.0);
    double const aside[3] = FEELER_ASIDE;
    EXPECT(fabs(s->joint_aside[1] - 1000.0 - 20.0 * FEELER_BETWEEN - aside[1]) < 1e-9);
    has_inverse = 0;
    add_line(20, 20, 0);
    EXPECT(last_segment()->joints == 0);
}

/* A change of the kinematics gives the planner another position: nothing goes on from there. */
static void ends_the_program_when_the_kinematics_change(void) {
    add_line(100, 0, 0);
    add_line(200, 0, 0);
    add_line(300, 0, 0);
    permit(2);
    cycle(1000);
    double const here = x_of();
    EXPECT(here > 1.0 && here < 100.0);
    EmcPose const there = at(here + 1000.0, 0, 0);
    joint_offset = 0.0;
    tpSetPos(&tp, &there);
    EXPECT(add_line(1400, 0, 0) == TP_ERR_FAIL);
    cycle(3000);
    EXPECT(tpIsDone(&tp) && x_of() < here + 1005.0); /* the way in which it brakes */
    EXPECT(ring->dropped == 3);
    EXPECT(add_line(1400, 0, 0) == TP_ERR_OK);
    EXPECT(last_segment()->follows_part == 1 && last_segment()->follows == 1);
    EXPECT(fabs(last_segment()->from[0] - x_of()) < 1e-9);
}

/* Nor if the position stays the same, as with rotary axes at 0, at rest or on the way. */
static void ends_the_program_at_a_switch_in_place(void) {
    for (int round = 0; round < 4; ++round) {
        int const is_moving = round % 2, is_same = round / 2; /* kinematics */
        EmcPose here;
        add_line(100, 0, 0);
        add_line(200, 0, 0);
        permit(ring->written - (is_same ? 0 : 1));
        if (!is_moving) tpPause(&tp);
        cycle(200);
        uint64_t const ended = ring->ended;
        tpGetPos(&tp, &here);
        if (!is_same) joint_offset += 1.0;
        tpSetPos(&tp, &here);
        EXPECT(ring->ended == ended + 1 && (motion.motionFlag & EMCMOT_MOTION_ERROR_BIT));
        EXPECT(add_line(300, 0, 0) == TP_ERR_FAIL);
        cycle(3000);
        EXPECT(tpIsDone(&tp) && x_of() < 20.0 && ring->dropped == ring->written);
        tpAbort(&tp); /* as LinuxCNC does after an error */
        motion.motionFlag = 0;
        cycle(5);
        EXPECT(add_line(0, 10.0 + round, 0) == TP_ERR_OK);
        permit(ring->written);
        cycle(3000);
        EXPECT(tpIsDone(&tp) && fabs(x_of()) < 1e-9);
    }
}

/* A position that is set while motions only wait. */
static void ends_the_program_when_a_position_is_set(void) {
    EmcPose const there = at(5, 0, 0);
    add_line(100, 0, 0);
    cycle(5);
    tpSetPos(&tp, &there);
    EXPECT(ring->ended == 1 && add_line(100, 0, 0) == TP_ERR_FAIL);
}

/* Another pin of the kinematics, while motions wait or are made. */
static void ends_the_program_when_a_pin_changes(void) {
    add_line(100, 0, 0);
    cycle(10);
    joint_offset = 5.0;
    permit(1);
    cycle(1000);
    EXPECT(tpIsDone(&tp) && x_of() == 0.0 && ring->ended == 1);
    tpAbort(&tp);
    cycle(5);
    add_line(100, 0, 0);
    permit(ring->written);
    cycle(200);
    has_inverse = 0;
    double const here = x_of();
    cycle(3000);
    EXPECT(here > 0.0 && tpIsDone(&tp) && x_of() < here + 5.0 && ring->ended == 2);
}

static double uniform(double low, double high) { return low + (high - low) * rand() / RAND_MAX; }

static EmcPose between(EmcPose const *a, EmcPose const *b, double t) {
    EmcPose p = at(a->tran.x + t * (b->tran.x - a->tran.x), a->tran.y + t * (b->tran.y - a->tran.y),
                   a->tran.z + t * (b->tran.z - a->tran.z));
    p.a = a->a + t * (b->a - a->a), p.c = a->c + t * (b->c - a->c);
    p.u = a->u + t * (b->u - a->u);
    return p;
}

static double distance(EmcPose const *a, EmcPose const *b) {
    return sqrt(pow(b->tran.x - a->tran.x, 2) + pow(b->tran.y - a->tran.y, 2)
                + pow(b->tran.z - a->tran.z, 2));
}

/* How far a pose is from a straight motion: `off` in its tip. The result is how far its angles and U are
 * from those that the motion has within `near` of the tip, as parts of what they may be. */
static double off_line(EmcPose const *p, EmcPose const *a, EmcPose const *b, double near, double *off) {
    double const length = distance(a, b);
    double const along = (p->tran.x - a->tran.x) * (b->tran.x - a->tran.x)
                         + (p->tran.y - a->tran.y) * (b->tran.y - a->tran.y)
                         + (p->tran.z - a->tran.z) * (b->tran.z - a->tran.z);
    double t = length > 0 ? along / (length * length) : 0;
    t = fmax(0, fmin(1, t));
    EmcPose const nearest = between(a, b, t);
    *off = distance(p, &nearest);
    if (*off > near) return 1e9;
    double const reach = length > 0 ? sqrt(near * near - *off * *off) / length : 1;
    double least = 1e9;
    for (int i = -200; i <= 200; ++i) {
        EmcPose const q = between(a, b, fmax(0, fmin(1, t + reach * i / 200)));
        least = fmin(least, fmax((fabs(q.a - p->a) + fabs(q.c - p->c)) / FEELER_TURN_ERROR,
                                 3.0 * fabs(q.u - p->u) / near));
    }
    return least;
}

/* Corners at which other axes move: the tip, the angles and U are never farther from the path than the
 * guard is told, and smooth ones are made without a stop. */
static void leaves_turning_corners_by_little(void) {
    srand(7);
    ring->feed_tolerance = 0.1;
    ring->turn_tolerance = 0.02;
    tpSetTermCond(&tp, TC_TERM_COND_PARABOLIC, 0.0);
    EmcPose pose[3];
    memset(pose, 0, sizeof pose);
    int smooth = 0, stopped = 0, sharp = 0, blended = 0;
    double farthest = 0, turned = 0;
    for (int k = 0; k < 3000; ++k) {
        int const is_smooth = k % 2, is_u_only = k % 6 == 0;
        double const turn = is_smooth ? uniform(-0.02, 0.02) : uniform(-3, 3);
        double const heading = uniform(-3, 3), rate = uniform(-1, 1), swing = uniform(-1, 1);
        double const length = pow(10, is_smooth ? uniform(-1, -0.3) : uniform(-1, 1.3));
        for (int i = 1; i < 3; ++i) {
            double const way = heading + (i == 2 ? turn : 0);
            double const l = length * (is_smooth ? 1 : i == 2 ? pow(10, uniform(-1, 1)) : 1);
            double const more = is_smooth ? uniform(0.995, 1.005) : uniform(-2, 2);
            pose[i] = pose[i - 1];
            pose[i].tran.x += l * cos(way), pose[i].tran.y += l * sin(way);
            pose[i].tran.z += is_smooth ? 0 : uniform(-1, 1) * l;
            pose[i].a += is_smooth ? rate * l * more : rand() % 4 && !is_u_only ? rate * more : 0;
            pose[i].c += is_smooth ? swing * l * more : rand() % 4 && !is_u_only ? swing * more : 0;
            pose[i].u += is_smooth ? 0.3 * l * more : rand() % 3 ? 0 : swing * more;
            tpSetId(&tp, ++line_number);
            EXPECT(tpAddLine(&tp, pose[i], 2, pow(10, uniform(0.5, 2)), 100,
                             pow(10, uniform(2, 3.5)), 0xff, 0, -1, tag) == TP_ERR_OK);
        }
        int const is_turning = pose[1].a != pose[0].a || pose[1].c != pose[0].c
                               || pose[2].a != pose[1].a || pose[2].c != pose[1].c
                               || pose[1].u != pose[0].u || pose[2].u != pose[1].u;
        double const most = last_segment()->tolerance * (FEELER_TURNING_CORNER - 1.0);
        permit(ring->written);
        if (is_smooth) EXPECT(last_segment()->tolerance == ring->turn_tolerance);
        int rests = 0;
        for (int i = 0; i < 200000; ++i) {
            cycle(1);
            EmcPose now;
            tpGetPos(&tp, &now);
            rests += motion_count > 0 && real_tpIsDone(&tp) && i > 5;
            EXPECT(!*pins->holding);
            double off[2];
            double const angle = fmin(off_line(&now, &pose[0], &pose[1], most, &off[0]),
                                      off_line(&now, &pose[1], &pose[2], most, &off[1]));
            if (is_turning) {
                farthest = fmax(farthest, fmin(off[0], off[1]) / most);
                turned = fmax(turned, angle);
            }
            if (i > 5 && tpIsDone(&tp)) break;
        }
        *(is_smooth ? &smooth : &sharp) += 1;
        *(is_smooth ? &stopped : &blended) += is_smooth ? rests > 0 : rests == 0;
        pose[0] = pose[2];
    }
    printf("smooth corners: %d, of which %d with a stop; others: %d, of which %d without; off the path by up to "
           "%.2f of what is told, other axes by %.2f\n",
           smooth, stopped, sharp, blended, farthest, turned);
    EXPECT(farthest <= 1.0 && turned <= 1.0);
    EXPECT(stopped < smooth / 20);
    EXPECT(farthest > 0.2 && turned > 0.01); /* it does blend */
}

/* Runs until all is made; the farthest that the planner is from two motions. */
static double farthest_off(double (*off)(EmcPose const *now, void const *path), void const *path) {
    double farthest = 0;
    for (int i = 0; i < 200000; ++i) {
        cycle(1);
        EmcPose now;
        tpGetPos(&tp, &now);
        farthest = fmax(farthest, off(&now, path));
        EXPECT(!*pins->holding);
        if (i > 5 && tpIsDone(&tp)) break;
    }
    return farthest;
}

/* Passes on a motion while the one before is beyond its middle: LinuxCNC then makes no blend arc. */
static void begin_first_of_two(double length, double feed) {
    permit(ring->written);
    cycle((int)(1000 * 0.7 * length / feed));
}

static double off_two_lines(EmcPose const *now, void const *path) {
    EmcPose const *const pose = path;
    double off[2];
    off_line(now, &pose[0], &pose[1], 0, &off[0]);
    off_line(now, &pose[1], &pose[2], 0, &off[1]);
    return fmin(off[0], off[1]);
}

/* The guard counts a corner with what accelerations allow (core/motion/corner.h). */
static void leaves_corners_by_no_more_than_the_guard_counts(void) {
    srand(11);
    ring->feed_tolerance = 0.1;
    tpSetTermCond(&tp, TC_TERM_COND_PARABOLIC, 0.0);
    EmcPose pose[3] = {at(0, 0, 0), at(0, 0, 0), at(0, 0, 0)};
    double most = 0, widest = 0;
    for (int k = 0; k < 700; ++k) {
        double acceleration[2], length[2];
        double const tolerance = pow(10, uniform(-1.5, 0.5)), feed = pow(10, uniform(0.5, 2));
        config.arcBlendEnable = k % 3 != 0;
        tpSetTermCond(&tp, TC_TERM_COND_PARABOLIC, tolerance);
        for (int i = 0; i < 2; ++i) {
            length[i] = pow(10, uniform(-0.5, 1.7));
            acceleration[i] = pow(10, uniform(2, 3.5));
            double const heading = uniform(-3.1, 3.1), height = uniform(-1, 1), flat = sqrt(1 - height * height);
            pose[i + 1] = at(pose[i].tran.x + length[i] * flat * cos(heading),
                             pose[i].tran.y + length[i] * flat * sin(heading),
                             pose[i].tran.z + length[i] * height);
            tpSetId(&tp, ++line_number);
            EXPECT(tpAddLine(&tp, pose[i + 1], 2, feed, 100, acceleration[i], 0xff, 0, -1, tag) == TP_ERR_OK);
            if (i == 0 && k % 2) begin_first_of_two(length[0], feed);
        }
        permit(ring->written);
        /* Those of all directions include that of the first motion. */
        double const root = sqrt(2.0 * fmax(1.0, acceleration[1] / acceleration[0]));
        double const told = 1.05 * 4.0 * pow(root / (1.0 + root), 2) * tolerance;
        double const off = farthest_off(off_two_lines, pose);
        most = fmax(most, off / told);
        widest = fmax(widest, off / tolerance);
        pose[0] = pose[2];
    }
    printf("off the path by up to %.2f of what the guard counts, %.2f times the tolerance\n", most, widest);
    EXPECT(most <= 1.0);
    EXPECT(most > 0.5 && widest > 1.2); /* it does blend */
}

/* A permit that comes while a short line is made: what follows is not displaced. */
static void ends_where_it_should_however_late_permits_come(void) {
    double const x[] = {0.82, 4.92, 34.92, 34.92}, y[] = {0, -0.51, -0.51, 29.49};
    for (int i = 0; i < 3; ++i) axis_speed[i] = 200, axis_acceleration[i] = 2000;
    real_tpSetVmax(&tp, 1e4, 1e4);
    real_tpSetVlimit(&tp, 1e4);
    ring->feed_tolerance = 0.1;
    tpSetTermCond(&tp, TC_TERM_COND_PARABOLIC, 0.05);
    for (int late = 0; late < 60; ++late) {
        EmcPose begin, now;
        tpGetPos(&tp, &begin);
        for (int i = 0; i < 4; ++i) {
            tpSetId(&tp, ++line_number);
            EXPECT(tpAddLine(&tp, at(begin.tran.x + x[i], begin.tran.y + y[i], 0), 2, 100, 200, 2000, 0xff, 0, -1, tag)
                   == TP_ERR_OK);
        }
        permit(ring->written - 3);
        cycle(late);
        if (late % 3 == 0) {
            permit(ring->written - 2);
            cycle(late / 2);
        }
        permit(ring->written);
        for (int i = 0; i < 20000 && (i < 5 || !tpIsDone(&tp)); ++i) cycle(1);
        tpGetPos(&tp, &now);
        EXPECT(fabs(now.tran.x - begin.tran.x - x[3]) < 1e-6 && fabs(now.tran.y - begin.tran.y - y[3]) < 1e-6);
    }
}

/* --- corners of LinuxCNC without feeler_tp ------------------------------------------------------*/

/* A corner of two motions; one may be an arc in the plane of X and Y. */
struct corner {
    double speed[3], acceleration[3]; /* of the axes */
    double tolerance, feed;           /* feed: 0 for rapids */
    EmcPose pose[3];                  /* the corner is the second one */
    int arc;                          /* 1: the first motion, 2: the second one */
    PmCartesian centre;
    double angle; /* of the arc; positive: counterclockwise */
    /* What the planner did: how far before and after the corner it left the path of two lines, and how
     * far it was from the path. */
    double before, after, off;
};

/* As LinuxCNC's emccanon.cc does: what the axes allow in this direction. */
static double along(double const *limit, EmcPose const *a, EmcPose const *b) {
    double const way[3] = {b->tran.x - a->tran.x, b->tran.y - a->tran.y, b->tran.z - a->tran.z};
    double most = 1e99;
    for (int i = 0; i < 3; ++i)
        if (way[i] != 0) most = fmin(most, limit[i] * distance(a, b) / fabs(way[i]));
    return most;
}

static struct corner draw_corner(int k) {
    struct corner c = {.tolerance = k % 4 == 0 ? 0 : pow(10, uniform(-2, 0.5)), .arc = k % 4 < 2 ? 0 : k % 4 - 1};
    double const same = pow(10, uniform(2, 3.5));
    for (int i = 0; i < 3; ++i) {
        c.speed[i] = pow(10, uniform(1, 2.3));
        c.acceleration[i] = k % 8 < 4 ? same : pow(10, uniform(2, 3.5));
    }
    /* Rapids are without a tolerance, or every third corner of lines. */
    if (c.tolerance > 0 && (c.arc || k % 3)) c.feed = pow(10, uniform(0.5, 2));
    double const length = pow(10, uniform(-0.3, 1.9)), heading = uniform(-3.1, 3.1);
    double const turn = k % 5 == 0 ? uniform(-0.3, 0.3) : uniform(-3.0, 3.0);
    double const height = c.arc ? 0 : uniform(-1, 1), flat = sqrt(1 - height * height);
    c.pose[0] = c.pose[1] = c.pose[2] = at(0, 0, 0);
    EmcPose *const far = c.arc == 1 ? &c.pose[2] : &c.pose[0]; /* of the line */
    double const sign = c.arc == 1 ? 1 : -1;
    *far = at(sign * length * flat * cos(heading), sign * length * flat * sin(heading), sign * length * height);
    if (!c.arc) {
        double const next = pow(10, uniform(-0.3, 1.9)), rise = fmax(-1, fmin(1, height + uniform(-0.5, 0.5))),
                     level = sqrt(1 - rise * rise);
        c.pose[2] = at(next * level * cos(heading + turn), next * level * sin(heading + turn), next * rise);
        return c;
    }
    double const radius = pow(10, uniform(0, 2)), side = k % 16 < 8 ? 1 : -1, tangent = heading + turn;
    c.angle = side * uniform(0.1, 6.0);
    c.centre.x = -side * radius * sin(tangent), c.centre.y = side * radius * cos(tangent), c.centre.z = 0;
    double const turned = c.arc == 1 ? tangent - c.angle : tangent + c.angle;
    double const rise = k % 3 == 0 ? radius * fabs(c.angle) * uniform(-0.2, 0.2) : 0; /* of a helix */
    c.pose[c.arc == 1 ? 0 : 2] =
        at(c.centre.x + side * radius * sin(turned), c.centre.y - side * radius * cos(turned), rise);
    return c;
}

static double off_corner(EmcPose const *now, struct corner const *c) {
    double least = 1e9;
    for (int i = 0; i < 2; ++i) {
        double off;
        if (c->arc == i + 1) {
            double const x = now->tran.x - c->centre.x, y = now->tran.y - c->centre.y;
            double const radius = hypot(c->centre.x, c->centre.y);
            /* The angle from the corner, along the arc; in the middle of the rest, it is in doubt by a turn. */
            double turned = atan2(c->centre.y * x - c->centre.x * y, -c->centre.x * x - c->centre.y * y);
            if ((c->angle > 0) == (c->arc == 1)) turned = -turned;
            if (turned < 0.5 * fabs(c->angle) - M_PI) turned += 2 * M_PI;
            double const part = fmax(0, fmin(1, turned / fabs(c->angle)));
            off = hypot(hypot(x, y) - radius, now->tran.z - part * c->pose[c->arc == 1 ? 0 : 2].tran.z);
        } else {
            off_line(now, &c->pose[i], &c->pose[i + 1], 0, &off);
        }
        least = fmin(least, off);
    }
    return least;
}

/* How far before and after the corner of two lines a place is, along both. */
static void note_reach(EmcPose const *now, struct corner *c) {
    double const *const a = &c->pose[0].tran.x, *const b = &c->pose[2].tran.x, *const p = &now->tran.x;
    double const first = distance(&c->pose[0], &c->pose[1]), second = distance(&c->pose[1], &c->pose[2]);
    double uv = 0, pu = 0, pv = 0;
    for (int i = 0; i < 3; ++i) {
        double const u = -a[i] / first, v = b[i] / second;
        uv += u * v, pu += p[i] * u, pv += p[i] * v;
    }
    if (1 - uv * uv < 1e-6) return;
    c->before = fmax(c->before, (uv * pv - pu) / (1 - uv * uv));
    c->after = fmax(c->after, (pv - uv * pu) / (1 - uv * uv));
}

static void make_corner(struct corner *c, int k) {
    PmCartesian const up = {0, 0, c->angle < 0 ? -1 : 1};
    memcpy(axis_speed, c->speed, sizeof axis_speed);
    memcpy(axis_acceleration, c->acceleration, sizeof axis_acceleration);
    real_tpClear(&tp);
    real_tpSetPos(&tp, &c->pose[0]);
    config.arcBlendEnable = k % 3 != 0;
    real_tpSetTermCond(&tp, TC_TERM_COND_PARABOLIC, c->tolerance);
    for (int i = 0; i < 2; ++i) {
        EmcPose const *const from = &c->pose[i], *const to = &c->pose[i + 1];
        int const is_arc = c->arc == i + 1;
        double const limit = is_arc ? fmin(c->speed[0], c->speed[1]) : along(c->speed, from, to);
        double acceleration =
            is_arc ? fmin(c->acceleration[0], c->acceleration[1]) : along(c->acceleration, from, to);
        double const rise = fabs(to->tran.z - from->tran.z);
        if (is_arc && rise > 0) acceleration = fmin(acceleration, c->acceleration[2]);
        double const speed = c->feed > 0 ? fmin(c->feed, limit) : limit;
        real_tpSetId(&tp, ++line_number);
        EXPECT((is_arc ? real_tpAddCircle(&tp, *to, c->centre, up, 0, 3, speed, limit, acceleration, 0xff, 0, tag)
                       : real_tpAddLine(&tp, *to, c->feed > 0 ? 2 : 1, speed, limit, acceleration, 0xff, 0, -1, tag))
               == TP_ERR_OK);
        double const length = is_arc ? hypot(hypot(c->centre.x, c->centre.y) * c->angle, rise) : distance(from, to);
        /* LinuxCNC makes no blend arc if the second one comes late. */
        if (i == 0 && k / 2 % 2)
            for (int n = (int)(700 * length / speed); n > 0; --n) real_tpRunCycle(&tp, 1000000);
    }
    for (int i = 0; i < 200000 && (i < 5 || !real_tpIsDone(&tp)); ++i) {
        EmcPose now;
        real_tpRunCycle(&tp, 1000000);
        tpGetPos(&tp, &now);
        double const off = off_corner(&now, c);
        c->off = fmax(c->off, off);
        if (!c->arc && off > 1e-4) note_reach(&now, c);
    }
    EXPECT(real_tpIsDone(&tp));
}

/* How the planner leaves corners. The file is what core's bounds of them are tested with. */
static void leaves_corners_as_recorded(void) {
    char const *const record = getenv("FEELER_RECORD_CORNERS"); /* a file to write instead */
    FILE *const file = fopen(record ? record : CORNERS, record ? "w" : "r");
    EXPECT(file != NULL);
    if (!file) return;
    char line[1000];
    if (record)
        fputs("# Corners of the planner of LinuxCNC 2.9: tests/guard/feeler_tp_test.c. mm, seconds, radians.\n"
              "# speeds and accelerations of X, Y, Z; tolerance (0: none); feed (0: rapids); from; corner is 0, 0, 0;\n"
              "# to; arc (1: first motion, 2: second); its centre; its angle; left before; after; off the path\n",
              file);
    else
        for (int i = 0; i < 3; ++i) EXPECT(fgets(line, sizeof line, file) != NULL);
    srand(31);
    for (int k = 0; k < 400; ++k) {
        struct corner c = draw_corner(k);
        make_corner(&c, k);
        if (record) {
            for (int i = 0; i < 3; ++i) fprintf(file, "%.9g ", c.speed[i]);
            for (int i = 0; i < 3; ++i) fprintf(file, "%.9g ", c.acceleration[i]);
            fprintf(file, "%.9g %.9g ", c.tolerance, c.feed);
            for (int i = 0; i < 3; i += 2)
                fprintf(file, "%.12g %.12g %.12g ", c.pose[i].tran.x, c.pose[i].tran.y, c.pose[i].tran.z);
            fprintf(file, "%d %.12g %.12g %.12g ", c.arc, c.centre.x, c.centre.y, c.angle);
            fprintf(file, "%.5f %.5f %.5f\n", c.before, c.after, c.off);
            continue;
        }
        EXPECT(fgets(line, sizeof line, file) != NULL);
        char const *end = line + strlen(line);
        for (int blanks = 0; end > line && blanks < 3; blanks += *--end == ' ') {}
        double before, after, off;
        EXPECT(sscanf(end, "%lf %lf %lf", &before, &after, &off) == 3);
        EXPECT(fabs(before - c.before) < 1e-3 && fabs(after - c.after) < 1e-3 && fabs(off - c.off) < 1e-3);
    }
    fclose(file);
}

/* A corner of two lines of X, Y, Z and A, at 0, and what the planner did there. */
struct turning_corner {
    double acceleration[4], tolerance, feed[2];
    double from[4], to[4];
    /* The part of the first line that was left when the second one had begun, and that of the second one
     * that was made when the first one ended. */
    double left, made;
    double off;  /* the farthest from places that are short of the end of the first line and on along the second */
};

static double way_of(double const *way) {
    double const length = sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]);
    return length > 0 ? length : fabs(way[3]);
}

static struct turning_corner draw_turning_corner(int k) {
    enum { WITHOUT_A, ONLY_A, ALL };
    static int const kinds[7][2] = {{WITHOUT_A, ONLY_A}, {WITHOUT_A, ALL}, {ONLY_A, WITHOUT_A}, {ONLY_A, ALL},
                                    {ALL, WITHOUT_A},    {ALL, ONLY_A},    {ALL, ALL}};
    struct turning_corner c = {.tolerance = pow(10, uniform(-2, 0))};
    for (int i = 0; i < 4; ++i) c.acceleration[i] = pow(10, uniform(1.7, 3.5));
    for (int i = 0; i < 2; ++i) {
        double *const way = i == 0 ? c.from : c.to;
        int const kind = kinds[k % 7][i];
        double const length = pow(10, uniform(-1, 2));
        if (kind != ONLY_A)
            for (int j = 0; j < 3; ++j) way[j] = length * uniform(-1, 1);
        if (kind != WITHOUT_A) way[3] = pow(10, uniform(-1, 2)) * uniform(-1, 1);
        c.feed[i] = pow(10, uniform(0.5, 2));
    }
    return c;
}

static void make_turning_corner(struct turning_corner *c, int k) {
    EmcPose pose[3];
    memset(pose, 0, sizeof pose);
    for (int i = 0; i < 3; i += 2) {
        double const *const way = i == 0 ? c->from : c->to;
        pose[i] = at(way[0], way[1], way[2]);
        pose[i].a = way[3];
    }
    real_tpClear(&tp);
    real_tpSetPos(&tp, &pose[0]);
    real_tpSetTermCond(&tp, TC_TERM_COND_PARABOLIC, c->tolerance);
    motion.net_feed_scale = k % 2 ? 1.2 : 1.0;
    for (int i = 0; i < 2; ++i) {
        double const *const way = i == 0 ? c->from : c->to, length = way_of(way);
        double acceleration = 1e99;
        for (int j = 0; j < 4; ++j)
            if (way[j] != 0) acceleration = fmin(acceleration, c->acceleration[j] * length / fabs(way[j]));
        real_tpSetId(&tp, ++line_number);
        EXPECT(real_tpAddLine(&tp, pose[i + 1], 2, c->feed[i], 1.2 * c->feed[i], acceleration, 0xff, 0, -1, tag)
               == TP_ERR_OK);
        if (i == 0 && k / 2 % 2)
            for (int n = (int)(700 * length / c->feed[0]); n > 0; --n) real_tpRunCycle(&tp, 1000000);
    }
    double uu = 0, uv = 0, vv = 0;
    for (int i = 0; i < 4; ++i)
        uu += c->from[i] * c->from[i], uv += c->from[i] * c->to[i], vv += c->to[i] * c->to[i];
    for (int i = 0; i < 1000000 && (i < 5 || !real_tpIsDone(&tp)); ++i) {
        EmcPose now;
        real_tpRunCycle(&tp, 1000000);
        tpGetPos(&tp, &now);
        double const p[4] = {now.tran.x, now.tran.y, now.tran.z, now.a};
        double pu = 0, pv = 0, off = 0;
        for (int j = 0; j < 4; ++j) pu += p[j] * c->from[j], pv += p[j] * c->to[j];
        double const short_of = (vv * pu - uv * pv) / (uu * vv - uv * uv), on = (uu * pv - uv * pu) / (uu * vv - uv * uv);
        for (int j = 0; j < 4; ++j) off = fmax(off, fabs(p[j] - short_of * c->from[j] - on * c->to[j]));
        c->off = fmax(c->off, off);
        if (on > 1e-6) c->left = fmax(c->left, short_of);
        if (short_of > 1e-6) c->made = fmax(c->made, on);
    }
    motion.net_feed_scale = 1.0;
    EXPECT(real_tpIsDone(&tp));
}

/* Where the planner begins to blend corners of X, Y, Z and A. */
static void leaves_turning_corners_as_recorded(void) {
    char const *const record = getenv("FEELER_RECORD_TURNS"); /* a file to write instead */
    FILE *const file = fopen(record ? record : TURNING_CORNERS, record ? "w" : "r");
    EXPECT(file != NULL);
    if (!file) return;
    char line[1000];
    if (record)
        fputs("# Corners of the planner of LinuxCNC 2.9: tests/guard/feeler_tp_test.c. mm, degrees, seconds.\n"
              "# accelerations of X, Y, Z, A; tolerance; both feeds; from; corner is 0; to; the part of the first\n"
              "# line that was left when the second one had begun; that of the second one made when the first one ended\n",
              file);
    else
        for (int i = 0; i < 3; ++i) EXPECT(fgets(line, sizeof line, file) != NULL);
    srand(37);
    for (int k = 0; k < 300; ++k) {
        struct turning_corner c = draw_turning_corner(k);
        make_turning_corner(&c, k);
        EXPECT(c.off < 1e-6);
        if (record) {
            for (int i = 0; i < 4; ++i) fprintf(file, "%.9g ", c.acceleration[i]);
            fprintf(file, "%.9g %.9g %.9g ", c.tolerance, c.feed[0], c.feed[1]);
            for (int i = 0; i < 4; ++i) fprintf(file, "%.12g ", c.from[i]);
            for (int i = 0; i < 4; ++i) fprintf(file, "%.12g ", c.to[i]);
            fprintf(file, "%.6f %.6f\n", c.left, c.made);
            continue;
        }
        EXPECT(fgets(line, sizeof line, file) != NULL);
        char const *end = line + strlen(line);
        for (int blanks = 0; end > line && blanks < 2; blanks += *--end == ' ') {}
        double left, made;
        EXPECT(sscanf(end, "%lf %lf", &left, &made) == 2);
        EXPECT(fabs(left - c.left) < 1e-4 && fabs(made - c.made) < 1e-4);
    }
    fclose(file);
}

/* A line, and an arc about `centre` in the plane of X and Y. */
struct line_and_arc {
    EmcPose from, corner;
    PmCartesian centre;
    double radius;
};
static double off_line_and_arc(EmcPose const *now, void const *path) {
    struct line_and_arc const *const p = path;
    double off;
    off_line(now, &p->from, &p->corner, 0, &off);
    double const apart = hypot(now->tran.x - p->centre.x, now->tran.y - p->centre.y) - p->radius;
    return fmin(off, hypot(apart, now->tran.z - p->corner.tran.z));
}

/* Corners with arcs keep to the path, whichever comes first and when. */
static void keeps_to_the_path_at_arcs(void) {
    srand(12);
    ring->feed_tolerance = 0.1;
    double farthest = 0;
    for (int k = 0; k < 1000; ++k) {
        EmcPose here;
        tpGetPos(&tp, &here);
        struct line_and_arc path = {.radius = pow(10, uniform(0, 2))};
        double const length = pow(10, uniform(0, 1.7)), heading = uniform(-3.1, 3.1), feed = pow(10, uniform(1, 2));
        double const turn = k % 4 == 0 ? 0 : uniform(-3.1, 3.1); /* 0: tangential */
        double const sweep = uniform(0.1, 6.0), acceleration = pow(10, uniform(2.5, 3.5));
        int const arc_first = k % 3 == 0, is_late = k % 2;
        config.arcBlendEnable = k % 5 != 0;
        tpSetTermCond(&tp, TC_TERM_COND_PARABOLIC, pow(10, uniform(-2, 0.3)));
        PmCartesian const up = {0, 0, 1};
        /* The arc is left of its heading, and begins or ends at the corner. */
        double const at_corner = heading + turn;
        double const end = arc_first ? at_corner - sweep : at_corner + sweep;
        EmcPose arc_end;
        if (arc_first) {
            path.centre = here.tran;
            path.centre.x -= path.radius * sin(end), path.centre.y += path.radius * cos(end);
            path.corner = here;
            path.corner.tran.x = path.centre.x + path.radius * sin(at_corner);
            path.corner.tran.y = path.centre.y - path.radius * cos(at_corner);
            path.from = path.corner;
            path.from.tran.x += length * cos(heading), path.from.tran.y += length * sin(heading);
            arc_end = path.corner;
        } else {
            path.from = path.corner = here;
            path.corner.tran.x += length * cos(heading), path.corner.tran.y += length * sin(heading);
            path.centre = path.corner.tran;
            path.centre.x -= path.radius * sin(at_corner), path.centre.y += path.radius * cos(at_corner);
            arc_end = path.corner;
            arc_end.tran.x = path.centre.x + path.radius * sin(end);
            arc_end.tran.y = path.centre.y - path.radius * cos(end);
        }
        for (int i = 0; i < 2; ++i) {
            int const is_arc = (i == 0) == arc_first;
            tpSetId(&tp, ++line_number);
            EXPECT((is_arc ? tpAddCircle(&tp, arc_end, path.centre, up, 0, 3, feed, 100, acceleration, 0xff, 0, tag)
                           : tpAddLine(&tp, arc_first ? path.from : path.corner, 2, feed, 100, acceleration, 0xff, 0,
                                       -1, tag))
                   == TP_ERR_OK);
            if (is_arc) EXPECT(last_segment()->blending == FEELER_EXACT_PATH);
            if (i == 0 && is_late) begin_first_of_two(arc_first ? path.radius * sweep : length, feed);
        }
        permit(ring->written);
        farthest = fmax(farthest, farthest_off(off_line_and_arc, &path));
    }
    printf("off the path by up to %.2g\n", farthest);
    EXPECT(farthest < 1e-5);
}

/* A contour of lines and arcs that touch each other is made without a stop. */
static void does_not_stop_between_a_line_and_an_arc_that_touch(void) {
    ring->feed_tolerance = 0.1;
    tpSetTermCond(&tp, TC_TERM_COND_PARABOLIC, 0.05);
    PmCartesian const up = {0, 0, 1}, centre = {40, 10, 0};
    add_line(40, 0, 0);
    EXPECT(tpAddCircle(&tp, at(50, 10, 0), centre, up, 0, 3, 50, 100, 1000, 0xff, 0, tag) == TP_ERR_OK);
    add_line(50, 50, 0);
    permit(ring->written);
    double slowest = 1e9;
    EmcPose before;
    tpGetPos(&tp, &before);
    for (int i = 0; i < 20000 && !(i > 5 && tpIsDone(&tp)); ++i) {
        cycle(1);
        EmcPose now;
        tpGetPos(&tp, &now);
        if (now.tran.x > 30 && now.tran.y < 20) slowest = fmin(slowest, distance(&before, &now) / 0.001);
        before = now;
    }
    EXPECT(before.tran.y > 49.999);
    EXPECT(slowest > 30);
}

/* A straight path of rotary axes alone cannot be left. */
static void passes_blocks_of_a_rotary_axis_without_a_stop(void) {
    ring->feed_tolerance = 0.1;
    ring->turn_tolerance = 0.02;
    EmcPose pose = at(0, 0, 0);
    for (int i = 0; i < 20; ++i) {
        pose.a += 1.0, pose.c += 0.5;
        EXPECT(tpAddLine(&tp, pose, 2, 30, 100, 1000, 0xff, 0, -1, tag) == TP_ERR_OK);
    }
    pose.c += 5.0; /* another direction */
    EXPECT(tpAddLine(&tp, pose, 2, 30, 100, 1000, 0xff, 0, -1, tag) == TP_ERR_OK);
    permit(ring->written);
    int rests = 0;
    for (int i = 0; i < 100000 && !(i > 5 && tpIsDone(&tp)); ++i) {
        cycle(1);
        rests += i > 5 && motion_count > 0 && real_tpIsDone(&tp);
    }
    EXPECT(tpIsDone(&tp) && rests == 1);
}

int main(int count, char **words) {
    struct {
        char const *name;
        void (*run)(void);
    } const cases[] = {
#define CASE(name) {#name, name}
        CASE(moves_only_as_far_as_permitted),
        CASE(never_passes_the_permit),
        CASE(ignores_permits_of_another_session),
        CASE(tells_where_an_abort_ended_a_motion),
        CASE(counts_nothing_that_waits_for_the_spindle),
        CASE(counts_no_thread_that_was_aborted),
        CASE(counts_no_motion_that_the_planner_refuses),
        CASE(keeps_a_pause_while_motions_wait),
        CASE(refuses_motions_while_an_abort_brakes),
        CASE(ends_synchronization_with_an_abort),
        CASE(stops_at_external_offsets),
        CASE(keeps_outputs_with_their_motions),
        CASE(keeps_path_modes_with_their_motions),
        CASE(counts_a_motion_once_the_next_one_is_over),
        CASE(begins_the_motion_after_a_tap_where_that_began),
        CASE(limits_the_rounding_of_feeds),
        CASE(tells_what_begins_at_rest),
        CASE(tells_how_the_spindle_turns),
        CASE(tells_which_way_a_probe_goes),
        CASE(runs_only_forwards),
        CASE(is_full_before_the_ring_is),
        CASE(asks_the_kinematics),
        CASE(ends_the_program_at_a_switch_in_place),
        CASE(ends_the_program_when_a_pin_changes),
        CASE(ends_the_program_when_a_position_is_set),
        CASE(leaves_turning_corners_by_little),
        CASE(leaves_corners_by_no_more_than_the_guard_counts),
        CASE(ends_where_it_should_however_late_permits_come),
        CASE(leaves_corners_as_recorded),
        CASE(leaves_turning_corners_as_recorded),
        CASE(keeps_to_the_path_at_arcs),
        CASE(does_not_stop_between_a_line_and_an_arc_that_touch),
        CASE(passes_blocks_of_a_rotary_axis_without_a_stop),
        CASE(ends_the_program_when_the_kinematics_change),
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; ++i) {
        if (count == 2 && strcmp(words[1], cases[i].name) != 0) continue;
        if (count != 2) {
            puts(cases[i].name);
            continue;
        }
        start();
        cases[i].run();
        return failures == 0 ? 0 : 1;
    }
    return count == 2 ? 2 : 0;
}
