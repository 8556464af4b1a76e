//! What the documented start leaves unsaid to the arm: its tool and its state.

use super::*;

/// Identity, but for a tool point.
const TOOL: [f32; 12] = [1.0, 0.0, 0.0, 0.1, 0.0, 1.0, 0.0, 0.05, 0.0, 0.0, 1.0, 0.25];

fn nominal(arm: *mut Truearm) -> [[f32; 4]; 3] {
    let mut pose = MaybeUninit::<TruearmPose>::uninit();
    // SAFETY: as the function wants it, which has written where there is no error.
    unsafe {
        assert_eq!(truearm_nominal_pose(arm, Q.as_ptr(), pose.as_mut_ptr()), TruearmError::Ok);
        pose.assume_init().matrix
    }
}

/// Where the nominal model has a point of the flange frame.
fn expected(tool: Option<[f32; 3]>) -> [[f32; 4]; 3] {
    let arm = Arm6::new(&Blob::check(BLOB).unwrap().parameters().unwrap());
    let arm =
        tool.map_or_else(|| arm.clone(), |[x, y, z]| arm.with_tool(Pose::translation(x, y, z)));
    TruearmPose::new(&arm.nominal().forward(&Q), true).matrix
}

/// A tool is the controller's, not the calibration's: who loads what was identified anew goes on
/// with it, as with `Arm::with_parameters`.
#[test]
fn the_tool_is_kept_from_parameters_to_parameters() {
    let mut memory = memory();
    let arm = loaded(&mut memory);
    assert_eq!(nominal(arm), expected(None), "the point that was measured");
    // SAFETY: as the function wants it.
    assert_eq!(unsafe { truearm_set_tool(arm, TOOL.as_ptr()) }, TruearmError::Ok);
    let with_tool = expected(Some([0.1, 0.05, 0.25]));
    assert_eq!(nominal(arm), with_tool);
    assert_eq!(load(arm, with_covariance()), TruearmError::Ok);
    assert_eq!(nominal(arm), with_tool, "loaded anew");
    // SAFETY: as the function wants it.
    let error = unsafe { truearm_set_settings(arm, &usual(), Q.as_ptr()) };
    assert_eq!(error, TruearmError::Ok);
    assert_eq!(nominal(arm), with_tool, "set anew");
    let arm = initialised(&mut memory);
    assert_eq!(load(arm, BLOB), TruearmError::Ok);
    assert_eq!(nominal(arm), expected(None), "begun anew");
}

/// The state to begin with is that of `Arm::state`, and a tick without one is told the same.
#[test]
fn the_neutral_state_can_be_had() {
    let mut memory = memory();
    let arm = initialised(&mut memory);
    let mut state = TruearmState { payload_kg: 7.0, ..NEUTRAL };
    // SAFETY: as the functions want it.
    unsafe {
        assert_eq!(truearm_default_state(arm, &mut state), TruearmError::NotLoaded);
        assert_eq!(state.payload_kg, 7.0);
        assert_eq!(load(arm, BLOB), TruearmError::Ok);
        assert_eq!(truearm_default_state(arm, &mut state), TruearmError::Ok);
    }
    let parameters: ArmParameters6<f32> = Blob::check(BLOB).unwrap().parameters().unwrap();
    assert_eq!(convert::state_of(&state), Ok(Arm6::new(&parameters).state()));
    assert_eq!(state.temperature_c, parameters.reference_temperature);

    let cold = TruearmState { temperature_c: 0.0, ..NEUTRAL };
    let [without, neutral, cold] = [null(), &raw const state, &raw const cold].map(|state| {
        let mut memory = self::memory();
        let arm = loaded(&mut memory);
        let mut tick = MaybeUninit::<TruearmTick>::uninit();
        // SAFETY: as the functions want it, which fill what they take.
        unsafe {
            assert_eq!(truearm_set_settings(arm, &quick(), Q.as_ptr()), TruearmError::Ok);
            assert_eq!(truearm_set_active(arm, 1), TruearmError::Ok);
            for _ in 0..QUICK {
                let error = truearm_tick(arm, Q.as_ptr(), state, tick.as_mut_ptr());
                assert_eq!(error, TruearmError::Ok);
            }
            tick.assume_init()
        }
    });
    assert_eq!((without.status, without.joints), (TruearmStatus::On, neutral.joints));
    assert_ne!(without.joints, cold.joints, "all zero is no neutral state");
}
