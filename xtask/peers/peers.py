"""Peers that are used from Python, on the arm of the others.

Arguments: the peer, the folder that `cargo xtask peers` wrote, `check` or `time`.
"""

import sys
import time

import numpy as np


def numpy_batch(links, arm, q):
    """All poses at once, a product of 4x4 matrices a joint: what a notebook does."""
    count = len(q)
    pose = np.broadcast_to(np.eye(4), (count, 4, 4))
    for joint in range(q.shape[1]):
        turn = np.zeros((count, 4, 4))
        sin, cos = np.sin(q[:, joint]), np.cos(q[:, joint])
        turn[:, 0, 0] = turn[:, 1, 1] = cos
        turn[:, 1, 0], turn[:, 0, 1] = sin, -sin
        turn[:, 2, 2] = turn[:, 3, 3] = 1
        pose = pose @ arm[joint] @ turn
    return (pose @ arm[-1])[:, :3, 3]


def of_numpy(links, arm):
    return {"batch": lambda q: numpy_batch(links, arm, q)}


def of_pinocchio(links, arm):
    """From Python, where its wheel cannot be compiled against."""
    import pinocchio as pin

    model, last = pin.Model(), 0
    for joint, before in enumerate(arm[:-1]):
        last = model.addJoint(last, pin.JointModelRZ(), pin.SE3(before), f"joint{joint}")
    tool = model.addFrame(pin.Frame("tool", last, 0, pin.SE3(arm[-1]), pin.FrameType.OP_FRAME))
    data = model.createData()

    def forward(q):
        points = np.empty((len(q), 3))
        for k, one in enumerate(q):
            pin.forwardKinematics(model, data, one)
            points[k] = pin.updateFramePlacement(model, data, tool).translation
        return points

    def jacobian(q):
        for one in q:
            last = pin.computeFrameJacobian(model, data, one, tool, pin.LOCAL_WORLD_ALIGNED)
        return last

    return {"forward": forward, "jacobian": jacobian}


def of_pybotics(links, arm):
    """It has no beta: check() says by how much that moves the tool."""
    from pybotics.robot import Robot

    robot = Robot.from_parameters(links[:, :4])
    robot.tool.position = arm[-1][:3, 3] - [0.0, 0.0, links[-1, 3]]
    forward = lambda q: np.array([robot.fk(one)[:3, 3] for one in q])
    jacobian = lambda q: [robot.jacobian_world(one) for one in q]
    return {"forward": forward, "jacobian": jacobian}


def main():
    peer, folder, what = sys.argv[1:]
    links = np.loadtxt(f"{folder}/links.txt")
    arm = np.zeros((len(links) + 1, 4, 4))
    arm[:, :3] = np.loadtxt(f"{folder}/arm.txt").reshape(-1, 3, 4)
    arm[:, 3, 3] = 1
    q = np.loadtxt(f"{folder}/poses.txt")
    functions = {"numpy": of_numpy, "pinocchio": of_pinocchio, "pybotics": of_pybotics}
    ways = functions[peer](links, arm)
    if what == "check":
        points = next(iter(ways.values()))(q)
        print(f"deviation {peer} {np.abs(points - np.loadtxt(f'{folder}/positions.txt')).max():.3g}")
        return
    for name, run in ways.items():
        start, passes = time.perf_counter(), 0
        while time.perf_counter() - start < 0.02:
            run(q)
            passes += 1
        print(f"time {peer} {name} {(time.perf_counter() - start) * 1e9 / passes / len(q):.9g}")


main()
