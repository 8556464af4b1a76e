/* C interface of truearm: calibrated kinematics of a six-joint arm, single precision.
 *
 * Generated from capi by `cargo xtask c --header`; do not edit.
 *
 * Units are SI: m, rad, kg, degrees Celsius. Joint values are encoder readings
 * without theta_offset. Poses are of the tool in the nominal base frame, the one
 * the controller commands. No function allocates, blocks or panics.
 */

#ifndef TRUEARM_H
#define TRUEARM_H

#include <stdint.h>
#include <stddef.h>

/*
 On every function: who does not look at its error is warned. Nothing for compilers that
 cannot, and where it is defined as nothing.
 */
#ifndef TRUEARM_NODISCARD
#if (defined(__cplusplus) && __cplusplus >= 201703L) || \
    (defined(_MSVC_LANG) && _MSVC_LANG >= 201703L) || \
    (defined(__STDC_VERSION__) && __STDC_VERSION__ >= 202311L)
#define TRUEARM_NODISCARD [[nodiscard]]
#elif defined(__GNUC__) || defined(__clang__)
#define TRUEARM_NODISCARD __attribute__((warn_unused_result))
#else
#define TRUEARM_NODISCARD
#endif
#endif

/*
 Joints of the arm.
 */
#define TRUEARM_JOINTS 6

/*
 Version of this interface: changes whenever a function, a structure or the
 memory it needs does.
 */
#define TRUEARM_VERSION 6

/*
 Bytes of memory that `truearm_init` needs.
 */
#define TRUEARM_MEMORY_SIZE 4288

/*
 Alignment of that memory.
 */
#define TRUEARM_MEMORY_ALIGN 8

/*
 What a function returns. 0 is success.
 */
enum TruearmError
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /*
   Done.
   */
  TRUEARM_ERROR_OK = 0,
  /*
   A pointer is NULL.
   */
  TRUEARM_ERROR_NULL = 1,
  /*
   A pointer is not aligned.
   */
  TRUEARM_ERROR_ALIGNMENT = 2,
  /*
   Header and library are of different versions.
   */
  TRUEARM_ERROR_VERSION = 3,
  /*
   Less memory than TRUEARM_MEMORY_SIZE.
   */
  TRUEARM_ERROR_MEMORY_SIZE = 4,
  /*
   The memory was not prepared by `truearm_init`.
   */
  TRUEARM_ERROR_NOT_INITIALISED = 5,
  /*
   No parameters have been loaded.
   */
  TRUEARM_ERROR_NOT_LOADED = 6,
  /*
   Not possible while compensation is on or being faded out.
   */
  TRUEARM_ERROR_ACTIVE = 7,
  /*
   The bytes are no valid blob; `truearm inspect` says why.
   */
  TRUEARM_ERROR_BAD_BLOB = 8,
  /*
   A valid blob of another robot.
   */
  TRUEARM_ERROR_OTHER_ROBOT = 9,
  /*
   A blob for another number of joints.
   */
  TRUEARM_ERROR_OTHER_ARM = 10,
  /*
   A setting makes no sense, or the joints to start at are not finite.
   */
  TRUEARM_ERROR_BAD_SETTING = 11,
  /*
   The tool is no rigid transform.
   */
  TRUEARM_ERROR_BAD_TOOL = 12,
  /*
   A pose is not finite: an input is not, or is out of range.
   */
  TRUEARM_ERROR_NOT_FINITE = 13,
  /*
   An approach of the state is none of `TruearmApproach`.
   */
  TRUEARM_ERROR_BAD_APPROACH = 14,
  /*
   The blob carries no covariance.
   */
  TRUEARM_ERROR_NO_COVARIANCE = 15,
  /*
   `has_torque` of the state is neither 0 nor 1: was all of it set?
   */
  TRUEARM_ERROR_BAD_STATE = 16,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum TruearmError TruearmError;
#else
typedef int32_t TruearmError;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 How far a tick went.
 */
enum TruearmStatus
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /*
   Switched off: the joints are the command.
   */
  TRUEARM_STATUS_OFF = 0,
  /*
   Being faded in or out.
   */
  TRUEARM_STATUS_RAMPING = 1,
  /*
   The whole correction, but for what was held back.
   */
  TRUEARM_STATUS_ON = 2,
  /*
   Refused, a command is infinite or NaN, or its pointer is bad: the joints of the last
   tick.
   */
  TRUEARM_STATUS_COMMAND_NOT_FINITE = 3,
  /*
   Refused, the state is infinite or NaN, or the tick returned an error of it: fading back
   to the command.
   */
  TRUEARM_STATUS_STATE_NOT_FINITE = 4,
  /*
   Refused, no finite pose at this command: fading back to the command.
   */
  TRUEARM_STATUS_OUT_OF_RANGE = 5,
  /*
   Refused, terms need torques and the state has none: fading back to the command.
   */
  TRUEARM_STATUS_TORQUE_UNKNOWN = 6,
  /*
   Refused, there is no arm or it has no parameters: the command as it is.
   */
  TRUEARM_STATUS_NO_ARM = 7,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum TruearmStatus TruearmStatus;
#else
typedef int32_t TruearmStatus;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 How a joint came to rest, or moves.
 */
enum TruearmApproach
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /*
   In -q.
   */
  TRUEARM_APPROACH_NEGATIVE = -1,
  /*
   Not known.
   */
  TRUEARM_APPROACH_UNKNOWN = 0,
  /*
   In +q.
   */
  TRUEARM_APPROACH_POSITIVE = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum TruearmApproach TruearmApproach;
#else
typedef int8_t TruearmApproach;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 What compensation has to meet.
 */
enum TruearmTask
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint8_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  /*
   The tool point.
   */
  TRUEARM_TASK_POSITION = 0,
  /*
   Tool point and orientation.
   */
  TRUEARM_TASK_POSE = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum TruearmTask TruearmTask;
#else
typedef uint8_t TruearmTask;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

/*
 One arm. Opaque: it lies in the caller's memory, is never freed and may be
 given up by no longer using it. Not to be used by two threads or by an
 interrupt and what it interrupts at once.
 */
typedef struct Truearm Truearm;

/*
 How compensation works; begin with `truearm_default_settings`.
 */
typedef struct TruearmSettings {
  /*
   Of `TruearmTask`.
   */
  uint8_t task;
  /*
   1: take the task of a pose although the arm's orientation was not
   identified, what points cannot see of it being nominal. Otherwise 0.
   */
  uint8_t trust_nominal_orientation;
  /*
   How often what is left is looked at and solved for again, 1 to 4.
   */
  uint8_t refinements;
  /*
   Ticks in which compensation is faded in and out, at most 2^24.
   */
  uint32_t ramp_ticks;
  /*
   An orientation error of 1 rad counts as much as one of this length, m, 0.001 to 10.
   */
  float rotation_length_m;
  /*
   Singular value of the Jacobian below which damping sets in, m per rad, 0.001 to 1;
   0.02 to 0.1 of the arm's reach keep what the book promises.
   */
  float singular_m;
  /*
   Largest correction of each joint, rad (m for a prismatic joint), above 0, at most 0.2.
   */
  float max_correction[TRUEARM_JOINTS];
  /*
   Largest change of a correction from tick to tick, rad (m), at most 0.2 and at least
   what sums are rounded by, 2^-19 of `max_correction`.
   */
  float max_change[TRUEARM_JOINTS];
} TruearmSettings;

/*
 What the terms of an arm depend on besides the joint values; begin with
 `truearm_default_state`. All zero is an arm at 0 degrees Celsius.
 */
typedef struct TruearmState {
  /*
   Of `TruearmApproach`, for each joint.
   */
  int8_t approach[TRUEARM_JOINTS];
  /*
   Mass at the payload point, kg.
   */
  float payload_kg;
  /*
   Temperature of the arm, degrees Celsius: what `truearm_arm_temperature` makes of
   the readings of its thermometer.
   */
  float temperature_c;
  /*
   1 if `torque` is known; otherwise it is that of the masses of the blob, and an arm
   without masses whose terms need it is not compensated.
   */
  uint8_t has_torque;
  /*
   What loads each joint, positive where it pulls towards +q as gravity's torque does:
   the opposite of what the joint holds, N m (N for a prismatic joint).
   */
  float torque[TRUEARM_JOINTS];
} TruearmState;

/*
 A pose of the tool in the nominal base frame.
 */
typedef struct TruearmPose {
  /*
   3 rows of 4: rotation, whose columns are the axes of the tool frame,
   and the tool point, m.
   */
  float matrix[3][4];
  /*
   1 within the joint ranges that the identification covered.
   */
  uint8_t covered;
} TruearmPose;

/*
 What a tick did. Sets of joints are bits: joint 1 is bit 0.
 */
typedef struct TruearmTick {
  /*
   Joints to command, rad (m): always finite, but that with TRUEARM_STATUS_NO_ARM a
   command that is no number leaves them as they were.
   */
  float joints[TRUEARM_JOINTS];
  /*
   How far it went.
   */
  TruearmStatus status;
  /*
   By how much the tool point misses its target at `joints`, m, where
   `has_error`.
   */
  float position_error_m[3];
  /*
   The same of the orientation, as a rotation vector, rad; to first order in
   the angle.
   */
  float rotation_error_rad[3];
  /*
   Damping near a singular pose, m^2; 0 away from them and where nothing
   was computed.
   */
  float damping_m2;
  /*
   Joints held back by max_correction.
   */
  uint16_t held_by_correction;
  /*
   Joints held back by max_change.
   */
  uint16_t held_by_change;
  /*
   Joints held back by a joint limit.
   */
  uint16_t held_by_limit;
  /*
   1 if the whole error was taken back: on, not damped, nothing held back.
   */
  uint8_t complete;
  /*
   1 if the remaining errors were computed: where a correction was, but not
   the whole.
   */
  uint8_t has_error;
  /*
   1 within the joint ranges that the identification covered; outside of
   them the correction is extrapolated; 0 also where none was computed.
   */
  uint8_t covered;
  /*
   1 if the data determined the orientation of the flange; otherwise only
   the tool point is better than nominal.
   */
  uint8_t orientation_identified;
} TruearmTick;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/*
 Prepares `memory` and gives the arm in it. First call of all.

 `version` must be TRUEARM_VERSION of the header the program was compiled
 with, `size` at least TRUEARM_MEMORY_SIZE; `memory` aligned to
 TRUEARM_MEMORY_ALIGN, kept and left alone as long as the arm is used.

 # Safety
 `memory` is NULL or `size` writable bytes, `arm` is NULL or writable.
 */
TRUEARM_NODISCARD
TruearmError truearm_init(uint32_t version,
                          void *memory,
                          size_t size,
                          struct Truearm **arm);

/*
 Reads a parameter blob (as `truearm pack` writes it), checked byte by byte,
 and starts over with its arm, switched off. What lies behind the blob is
 ignored, so that a whole memory slot may be given. It must stay there as long
 as the arm is used: tables of effects and the covariance are not copied.

 The tool is that of `truearm_set_tool`, kept from parameters to parameters. Until that
 was called it is the point that was measured (the reflector of the calibration), and
 ticks correct that one.

 `robot_id` is the id of this robot, as `truearm inspect` prints it: another
 robot's blob is refused. `joints` are where the arm stands, rad. Refused
 while compensation is on or being faded out; on an error nothing changes.

 Takes 21 KB of stack on a Cortex-M4F: call it where there is room.

 # Safety
 `blob` is NULL or `size` bytes, readable and unchanged as long as the arm is
 used; other pointers NULL or as typed.
 */
TRUEARM_NODISCARD
TruearmError truearm_load(struct Truearm *arm,
                          const uint8_t *blob,
                          size_t size,
                          uint64_t robot_id,
                          const struct TruearmSettings *settings,
                          const float *joints);

/*
 The usual settings for an arm of about a metre, for a task of
 `TruearmTask`.

 # Safety
 `settings` is NULL or writable.
 */
TRUEARM_NODISCARD
TruearmError truearm_default_settings(uint8_t task,
                                      struct TruearmSettings *settings);

/*
 Starts over with other settings, switched off; `joints` are where the arm
 stands, rad. Refused while compensation is on or being faded out.

 # Safety
 Every pointer is NULL or as typed.
 */
TRUEARM_NODISCARD
TruearmError truearm_set_settings(struct Truearm *arm,
                                  const struct TruearmSettings *settings,
                                  const float *joints);

/*
 The production tool: a rigid transform from the tool frame to the flange
 frame, 3 rows of 4 (rotation, then translation in m). Also while
 compensation is on; what is applied goes over to it by max_change a tick.
 Call it once after the first `truearm_load`: until then the tool is the point
 that was measured in the calibration. It is kept, whatever is loaded or set,
 until it is given another one or `truearm_init` begins anew.

 # Safety
 Every pointer is NULL or as typed; `tool` points to 12 floats.
 */
TRUEARM_NODISCARD TruearmError truearm_set_tool(struct Truearm *arm, const float *tool);

/*
 Switches compensation on (any number but 0) or off from the next tick on;
 it is faded in and out, by the ticks whose commands are finite.

 # Safety
 `arm` is NULL or came from `truearm_init`.
 */
TRUEARM_NODISCARD TruearmError truearm_set_active(struct Truearm *arm, int32_t active);

/*
 Where the tool really is at encoder readings, rad. Without a state (NULL):
 no payload, at the reference temperature, approach unknown.

 # Safety
 Every pointer is NULL or as typed; `encoders` points to 6 floats.
 */
TRUEARM_NODISCARD
TruearmError truearm_real_pose(struct Truearm *arm,
                               const float *encoders,
                               const struct TruearmState *state,
                               struct TruearmPose *pose);

/*
 Where the tool is by the nominal model, which is the controller's own.

 # Safety
 Every pointer is NULL or as typed; `joints` points to 6 floats.
 */
TRUEARM_NODISCARD
TruearmError truearm_nominal_pose(struct Truearm *arm,
                                  const float *joints,
                                  struct TruearmPose *pose);

/*
 One standard deviation of where the tool really is at encoder readings, rad,
 along x, y and z of the nominal base frame, m: of the identification, within
 the joint ranges that it covered. Without a state (NULL) as for
 `truearm_real_pose`. A tool of `truearm_set_tool` counts as exact. Takes some
 ten thousand instructions: for a check point, not for every tick.

 # Safety
 Every pointer is NULL or as typed; `encoders` points to 6 floats, `sigma` to 3.
 */
TRUEARM_NODISCARD
TruearmError truearm_point_sigma(struct Truearm *arm,
                                 const float *encoders,
                                 const struct TruearmState *state,
                                 float *sigma);

/*
 The state to begin with: no payload, at the reference temperature of the parameters,
 approach unknown, no torques read. What is known of the arm is then written over it.

 # Safety
 Every pointer is NULL or as typed.
 */
TRUEARM_NODISCARD
TruearmError truearm_default_state(struct Truearm *arm,
                                   struct TruearmState *state);

/*
 The temperature of the arm for `temperature_c` of a state, degrees Celsius, at a
 reading of its thermometer that was taken `dt_s` seconds after the one before: the
 reading itself, unless the arm was found to follow it late. The first reading after
 `truearm_init` is where the arm begins, as nothing is known of what was before. Call
 it with every reading, once a second or in every tick; one that is no number lets
 time pass.

 # Safety
 Every pointer is NULL or as typed.
 */
TRUEARM_NODISCARD
TruearmError truearm_arm_temperature(struct Truearm *arm,
                                     float dt_s,
                                     float reading_c,
                                     float *temperature_c);

/*
 One control tick: the joints, rad, at which the real tool is where the
 nominal model has it at `command`, rad. Without a state (NULL) as for
 `truearm_real_pose`. TRUEARM_ERROR_OK whatever the numbers: `tick` then holds
 finite joints, and its status says whether they are compensated.

 On an error stop, as on a status from TRUEARM_STATUS_COMMAND_NOT_FINITE on. `tick` is
 written all the same, so that what is sent until the arm stands is no garbage:

 - TRUEARM_ERROR_NULL, TRUEARM_ERROR_ALIGNMENT: a pointer is bad. That of `command`: the
   joints of the last tick, TRUEARM_STATUS_COMMAND_NOT_FINITE. That of `state`, not aligned:
   as for a bad state. That of `arm`: as without an arm. That of `tick`: nothing happens.
 - TRUEARM_ERROR_BAD_STATE, TRUEARM_ERROR_BAD_APPROACH: a field of the state is none of its
   values. The correction of the last good state fades, as if switched off for this tick, without
   a step: TRUEARM_STATUS_STATE_NOT_FINITE.
 - TRUEARM_ERROR_NOT_INITIALISED, TRUEARM_ERROR_NOT_LOADED: there is no arm, or it has no
   parameters. The command as it is, uncorrected, however far that is from the joints of the
   last tick: TRUEARM_STATUS_NO_ARM.

 # Safety
 Every pointer is NULL or as typed; `command` points to 6 floats.
 */
TRUEARM_NODISCARD
TruearmError truearm_tick(struct Truearm *arm,
                          const float *command,
                          const struct TruearmState *state,
                          struct TruearmTick *tick);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* TRUEARM_H */
