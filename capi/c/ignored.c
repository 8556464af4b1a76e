/*
 * A program that looks at no error: of every function the compiler must warn, or it has no
 * way to and says so by an empty TRUEARM_NODISCARD. Not linked with anything.
 */

#include "truearm.h"

void ignored(struct Truearm *arm, void *memory, const uint8_t *blob, float *q);

void ignored(struct Truearm *arm, void *memory, const uint8_t *blob, float *q)
{
    struct TruearmSettings settings;
    struct TruearmState state;
    struct TruearmTick tick;
    struct TruearmPose pose;

    truearm_init(TRUEARM_VERSION, memory, TRUEARM_MEMORY_SIZE, &arm);
    truearm_default_settings(TRUEARM_TASK_POSITION, &settings);
    truearm_load(arm, blob, 1024, 0, &settings, q);
    truearm_set_settings(arm, &settings, q);
    truearm_set_tool(arm, q);
    truearm_set_active(arm, 1);
    truearm_default_state(arm, &state);
    truearm_arm_temperature(arm, 1, 20, &state.temperature_c);
    truearm_tick(arm, q, &state, &tick);
    truearm_real_pose(arm, q, &state, &pose);
    truearm_nominal_pose(arm, q, &pose);
    truearm_point_sigma(arm, q, &state, q);
}
