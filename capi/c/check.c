/*
 * truearm from C: parameters from a slot, poses and ticks over the shipped
 * vectors, whose hashes must be those of the Rust images, and what must be
 * refused. The layout of the vector file is in tests/firmware/src/vectors.rs.
 */

#include "check.h"
#include "truearm.h"

#define ANGLES 64
#define OFF 900

static _Alignas(TRUEARM_MEMORY_ALIGN) uint8_t memory[TRUEARM_MEMORY_SIZE];
static const uint8_t *blob, *vectors;
static size_t blob_size;
static int failed;

#define EXPECT(call, result)                                                   \
    do {                                                                       \
        if ((call) != (result)) {                                              \
            say("FAILED: " #call " is not " #result "\n");                     \
            failed = 1;                                                        \
        }                                                                      \
    } while (0)

/* CRC-64/XZ of numbers as little-endian doubles. */
static void hash(uint64_t *crc, const float *values, int count)
{
    for (int i = 0; i < count; i++) {
        union {
            double number;
            uint8_t bytes[8];
        } value = {values[i]};
        for (int byte = 0; byte < 8; byte++) {
            *crc ^= value.bytes[byte];
            for (int bit = 0; bit < 8; bit++)
                *crc = *crc >> 1 ^ (*crc & 1 ? 0xC96C5795D7870F42u : 0);
        }
    }
}

void say_hex(const char *name, uint64_t value)
{
    char text[18];
    for (int i = 0; i < 16; i++)
        text[i] = "0123456789abcdef"[value >> (60 - 4 * i) & 15];
    text[16] = '\n';
    text[17] = 0;
    say(name);
    say(text);
}

static uint64_t word64(const uint8_t *bytes)
{
    uint64_t word = 0;
    for (int i = 7; i >= 0; i--)
        word = word << 8 | bytes[i];
    return word;
}

static const float *pose(uint32_t index)
{
    return (const float *)(vectors + ANGLES) + TRUEARM_JOINTS * index;
}

static TruearmState state(uint32_t index)
{
    TruearmState state = {.payload_kg = index % 11, .temperature_c = 10 + index % 31};
    uint32_t digits = index;
    for (int j = 0; j < TRUEARM_JOINTS; j++, digits /= 3)
        state.approach[j] = (int8_t)(digits % 3) - 1;
    state.has_torque = index % 5 == 0;
    for (uint32_t j = 0; j < TRUEARM_JOINTS; j++)
        state.torque[j] = (float)(index * (j + 3) % 97) - 48;
    return state;
}

/* Columns of the rotation, then the translation. */
static void hash_pose(uint64_t *crc, const TruearmPose *pose)
{
    for (int column = 0; column < 4; column++)
        for (int row = 0; row < 3; row++)
            hash(crc, &pose->matrix[row][column], 1);
}

static void compare(const char *name, uint64_t crc, const uint8_t *expected)
{
    say_hex(name, ~crc);
    if (~crc != word64(expected)) {
        say_hex("FAILED: Rust computed ", word64(expected));
        failed = 1;
    }
}

static void poses(Truearm *arm, uint32_t count)
{
    uint64_t crc = ~0ull;
    for (uint32_t i = 0; i < count; i++) {
        TruearmPose real;
        TruearmState now = state(i);
        EXPECT(truearm_real_pose(arm, pose(i), NULL, &real), TRUEARM_ERROR_OK);
        hash_pose(&crc, &real);
        EXPECT(truearm_real_pose(arm, pose(i), &now, &real), TRUEARM_ERROR_OK);
        hash_pose(&crc, &real);
    }
    compare("hash poses: ", crc, vectors + 16);
}

static void ticks(Truearm *arm, uint32_t count)
{
    static const uint8_t tasks[] = {TRUEARM_TASK_POSE, TRUEARM_TASK_POSITION};
    uint64_t crc = ~0ull;
    for (int t = 0; t < 2; t++) {
        TruearmSettings settings;
        EXPECT(truearm_default_settings(tasks[t], &settings), TRUEARM_ERROR_OK);
        settings.refinements = tasks[t] == TRUEARM_TASK_POSE ? 1 : 2;
        settings.trust_nominal_orientation = 1;
        settings.ramp_ticks = 100;
        EXPECT(truearm_set_settings(arm, &settings, pose(0)), TRUEARM_ERROR_OK);
        for (uint32_t i = 0; i < count; i++) {
            TruearmTick tick;
            TruearmState now = state(i);
            EXPECT(truearm_set_active(arm, i < OFF), TRUEARM_ERROR_OK);
            EXPECT(truearm_tick(arm, pose(i), &now, &tick), TRUEARM_ERROR_OK);
            hash(&crc, tick.joints, TRUEARM_JOINTS);
            hash(&crc, tick.position_error_m, 3);
            hash(&crc, tick.rotation_error_rad, 3);
            hash(&crc, &tick.damping_m2, 1);
        }
    }
    compare("hash ticks: ", crc, vectors + 32);
}

/* What a start that says no more than it has to begins with, and what stays when
 * parameters are loaded anew. */
static void starts(Truearm *arm, uint64_t robot)
{
    static const float tool[12] = {1, 0, 0, 0.1f, 0, 1, 0, 0.05f, 0, 0, 1, 0.25f};
    TruearmPose measured, before, after, by_default, by_null;
    TruearmSettings settings;
    TruearmState now = {.payload_kg = 7};
    TruearmTick with_state, without;

    EXPECT(truearm_nominal_pose(arm, pose(0), &measured), TRUEARM_ERROR_OK);
    EXPECT(truearm_set_tool(arm, tool), TRUEARM_ERROR_OK);
    EXPECT(truearm_nominal_pose(arm, pose(0), &before), TRUEARM_ERROR_OK);
    EXPECT(truearm_default_settings(TRUEARM_TASK_POSITION, &settings), TRUEARM_ERROR_OK);
    settings.ramp_ticks = 0;
    EXPECT(truearm_load(arm, blob, blob_size, robot, &settings, pose(0)), TRUEARM_ERROR_OK);
    EXPECT(truearm_nominal_pose(arm, pose(0), &after), TRUEARM_ERROR_OK);
    for (int row = 0; row < 3; row++) {
        EXPECT(after.matrix[row][3] == before.matrix[row][3], 1);
        EXPECT(after.matrix[row][3] == measured.matrix[row][3], 0);
    }

    EXPECT(truearm_default_state(arm, &now), TRUEARM_ERROR_OK);
    EXPECT(now.payload_kg == 0, 1);
    EXPECT(truearm_real_pose(arm, pose(0), &now, &by_default), TRUEARM_ERROR_OK);
    EXPECT(truearm_real_pose(arm, pose(0), NULL, &by_null), TRUEARM_ERROR_OK);
    EXPECT(truearm_set_active(arm, 1), TRUEARM_ERROR_OK);
    for (int i = 0; i < 1000; i++)
        EXPECT(truearm_tick(arm, pose(0), &now, &with_state), TRUEARM_ERROR_OK);
    EXPECT(truearm_tick(arm, pose(0), NULL, &without), TRUEARM_ERROR_OK);
    EXPECT(without.status, TRUEARM_STATUS_ON);
    for (int i = 0; i < TRUEARM_JOINTS; i++)
        EXPECT(without.joints[i] == with_state.joints[i], 1);
    for (int row = 0; row < 3; row++)
        EXPECT(by_default.matrix[row][3] == by_null.matrix[row][3], 1);
}

/* Whoever does not look at an error sends joints all the same: near to those of the
 * tick before, and of a status that says what they are. */
static void errors(Truearm *arm)
{
    union {
        uint8_t bytes[sizeof(TruearmState)];
        TruearmState state;
    } unset;
    TruearmSettings settings;
    TruearmTick last, tick = {.status = TRUEARM_STATUS_ON, .complete = 1};

    for (size_t i = 0; i < sizeof unset.bytes; i++)
        unset.bytes[i] = 0xaa;
    EXPECT(truearm_default_settings(TRUEARM_TASK_POSITION, &settings), TRUEARM_ERROR_OK);
    EXPECT(truearm_tick(arm, pose(0), NULL, &last), TRUEARM_ERROR_OK);
    EXPECT(truearm_tick(arm, NULL, NULL, &tick), TRUEARM_ERROR_NULL);
    EXPECT(tick.status, TRUEARM_STATUS_COMMAND_NOT_FINITE);
    for (int i = 0; i < TRUEARM_JOINTS; i++)
        EXPECT(tick.joints[i] == last.joints[i], 1);
    for (int ticks = 0; ticks < 5000; ticks++) {
        EXPECT(truearm_tick(arm, pose(0), &unset.state, &tick), TRUEARM_ERROR_BAD_APPROACH);
        EXPECT(tick.status, TRUEARM_STATUS_STATE_NOT_FINITE);
        EXPECT(tick.complete, 0);
        for (int i = 0; i < TRUEARM_JOINTS; i++) {
            float step = tick.joints[i] - last.joints[i];
            EXPECT(step * step <= 1.1f * settings.max_change[i] * settings.max_change[i], 1);
        }
        last = tick;
    }
    for (int i = 0; i < TRUEARM_JOINTS; i++)
        EXPECT(tick.joints[i] == pose(0)[i], 1);
    EXPECT(truearm_default_state(arm, &unset.state), TRUEARM_ERROR_OK);
    unset.state.has_torque = 7;
    EXPECT(truearm_tick(arm, pose(0), &unset.state, &tick), TRUEARM_ERROR_BAD_STATE);
    EXPECT(tick.status, TRUEARM_STATUS_STATE_NOT_FINITE);
    settings.trust_nominal_orientation = 77;
    EXPECT(truearm_set_active(arm, 0), TRUEARM_ERROR_OK);
    EXPECT(truearm_tick(arm, pose(0), NULL, &tick), TRUEARM_ERROR_OK);
    EXPECT(truearm_set_settings(arm, &settings, pose(0)), TRUEARM_ERROR_BAD_SETTING);
    settings.trust_nominal_orientation = 0;
    EXPECT(truearm_set_settings(arm, &settings, pose(0)), TRUEARM_ERROR_OK);
}

/* Every error that a mistake of the caller gives. */
static void refusals(Truearm *arm, uint64_t robot)
{
    static _Alignas(8) uint8_t other[TRUEARM_MEMORY_SIZE];
    static uint8_t damaged[1024];
    float q[TRUEARM_JOINTS] = {0};
    float tool[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0.1f};
    Truearm *none = NULL;
    TruearmState now = {.temperature_c = 20};
    TruearmTick tick;
    TruearmPose nominal, with_tool;
    TruearmSettings settings;

    EXPECT(truearm_init(TRUEARM_VERSION + 1, other, sizeof other, &none), TRUEARM_ERROR_VERSION);
    EXPECT(truearm_init(TRUEARM_VERSION, NULL, sizeof other, &none), TRUEARM_ERROR_NULL);
    EXPECT(truearm_init(TRUEARM_VERSION, other, sizeof other, NULL), TRUEARM_ERROR_NULL);
    EXPECT(truearm_init(TRUEARM_VERSION, other, sizeof other - 1, &none), TRUEARM_ERROR_MEMORY_SIZE);
    EXPECT(truearm_init(TRUEARM_VERSION, other + 4, sizeof other, &none), TRUEARM_ERROR_ALIGNMENT);
    EXPECT(truearm_tick((Truearm *)other, q, &now, &tick), TRUEARM_ERROR_NOT_INITIALISED);
    EXPECT(truearm_init(TRUEARM_VERSION, other, sizeof other, &none), TRUEARM_ERROR_OK);
    EXPECT(truearm_tick(none, q, &now, &tick), TRUEARM_ERROR_NOT_LOADED);

    EXPECT(truearm_default_settings(2, &settings), TRUEARM_ERROR_BAD_SETTING);
    EXPECT(truearm_default_settings(TRUEARM_TASK_POSE, &settings), TRUEARM_ERROR_OK);
    EXPECT(truearm_load(none, blob, blob_size, robot + 1, &settings, q), TRUEARM_ERROR_OTHER_ROBOT);
    EXPECT(truearm_load(none, blob, 100, robot, &settings, q), TRUEARM_ERROR_BAD_BLOB);
    EXPECT(truearm_load(none, NULL, 100, robot, &settings, q), TRUEARM_ERROR_NULL);
    for (size_t i = 0; i < sizeof damaged; i++)
        damaged[i] = blob[i];
    damaged[200] ^= 1;
    EXPECT(truearm_load(none, damaged, sizeof damaged, robot, &settings, q), TRUEARM_ERROR_BAD_BLOB);

    settings.refinements = 5;
    EXPECT(truearm_set_settings(arm, &settings, q), TRUEARM_ERROR_BAD_SETTING);
    EXPECT(truearm_set_settings(arm, (TruearmSettings *)((uintptr_t)&settings + 1), q),
           TRUEARM_ERROR_ALIGNMENT);
    EXPECT(truearm_tick(arm, NULL, &now, &tick), TRUEARM_ERROR_NULL);
    EXPECT(truearm_tick(arm, q, &now, NULL), TRUEARM_ERROR_NULL);
    EXPECT(truearm_tick(NULL, q, &now, &tick), TRUEARM_ERROR_NULL);
    now.approach[2] = 2;
    EXPECT(truearm_tick(arm, q, &now, &tick), TRUEARM_ERROR_BAD_APPROACH);
    EXPECT(truearm_real_pose(arm, q, &now, &nominal), TRUEARM_ERROR_BAD_APPROACH);
    now.approach[2] = TRUEARM_APPROACH_NEGATIVE;

    float sigma[3];
    EXPECT(truearm_point_sigma(arm, q, &now, sigma), TRUEARM_ERROR_NO_COVARIANCE);

    EXPECT(truearm_nominal_pose(arm, q, &nominal), TRUEARM_ERROR_OK);
    tool[0] = 2;
    EXPECT(truearm_set_tool(arm, tool), TRUEARM_ERROR_BAD_TOOL);
    tool[0] = 1;
    EXPECT(truearm_set_tool(arm, tool), TRUEARM_ERROR_OK);
    EXPECT(truearm_nominal_pose(arm, q, &with_tool), TRUEARM_ERROR_OK);
    EXPECT(nominal.matrix[1][3] == with_tool.matrix[1][3], 0);
    EXPECT(truearm_set_active(arm, 1), TRUEARM_ERROR_OK);
    EXPECT(truearm_tick(arm, q, &now, &tick), TRUEARM_ERROR_OK);
    EXPECT(tick.status, TRUEARM_STATUS_RAMPING);
    settings.refinements = 1;
    EXPECT(truearm_set_settings(arm, &settings, q), TRUEARM_ERROR_ACTIVE);
    EXPECT(truearm_load(arm, blob, blob_size, robot, &settings, q), TRUEARM_ERROR_ACTIVE);
    now.payload_kg = q[2] = __builtin_nanf("");
    EXPECT(truearm_tick(arm, q, &now, &tick), TRUEARM_ERROR_OK);
    EXPECT(tick.status, TRUEARM_STATUS_COMMAND_NOT_FINITE);
    EXPECT(truearm_real_pose(arm, q, NULL, &nominal), TRUEARM_ERROR_NOT_FINITE);
}

int check(const uint8_t *slot, size_t size, const uint8_t *expected)
{
    Truearm *arm = NULL;
    TruearmSettings settings;
    blob = slot;
    blob_size = size;
    vectors = expected;
    /* A controller knows its own; here it is the blob's, see blob/FORMAT.md. */
    uint64_t robot = word64(blob + 16);
    uint32_t count = (uint32_t)word64(vectors + 4);

    EXPECT(truearm_init(TRUEARM_VERSION, memory, sizeof memory, &arm), TRUEARM_ERROR_OK);
    EXPECT(truearm_default_settings(TRUEARM_TASK_POSE, &settings), TRUEARM_ERROR_OK);
    settings.trust_nominal_orientation = 1;
    EXPECT(truearm_load(arm, blob, blob_size, robot, &settings, pose(0)), TRUEARM_ERROR_OK);
    if (failed)
        return 1;
    poses(arm, count);
    ticks(arm, count);
    starts(arm, robot);
    errors(arm);
    refusals(arm, robot);
    say(failed ? "" : "ok: C gives the bits of Rust\n");
    return failed;
}
