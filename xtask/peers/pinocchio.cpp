// Pinocchio on the arm of the other peers. Arguments: folder of the files that
// `cargo xtask peers` wrote, and whether to check (`check`) or to time (`time`).
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include <pinocchio/multibody.hpp>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/jacobian.hpp>
#include <pinocchio/algorithm/kinematics.hpp>
#include <pinocchio/algorithm/regressor.hpp>

namespace pin = pinocchio;
using Clock = std::chrono::steady_clock;

static std::vector<double> numbers(const std::string &path) {
  std::ifstream file(path);
  std::vector<double> all;
  for (double value; file >> value;) all.push_back(value);
  return all;
}

template <class Run> static void time(const char *what, std::size_t poses, Run run) {
  const auto start = Clock::now();
  double passed = 0;
  int passes = 0;
  while (passed < 0.01) {
    run();
    ++passes;
    passed = std::chrono::duration<double>(Clock::now() - start).count();
  }
  std::printf("time pinocchio %s %.9g\n", what, passed * 1e9 / passes / poses);
}

int main(int count, char **arguments) {
  if (count != 3) return 2;
  const std::string folder = arguments[1];
  const auto arm = numbers(folder + "/arm.txt");
  pin::Model model;
  pin::JointIndex last = 0;
  pin::SE3 behind = pin::SE3::Identity();
  for (std::size_t at = 0; at + 12 <= arm.size(); at += 12) {
    Eigen::Matrix3d turn;
    Eigen::Vector3d point;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) turn(row, column) = arm[at + 4 * row + column];
      point(row) = arm[at + 4 * row + 3];
    }
    behind = pin::SE3(turn, point);
    // What comes last is the tool.
    if (at + 24 <= arm.size())
      last = model.addJoint(last, pin::JointModelRZ(), behind, "joint" + std::to_string(at / 12));
  }
  const auto tool = model.addFrame(pin::Frame("tool", last, 0, behind, pin::OP_FRAME));
  pin::Data data(model);
  const auto values = numbers(folder + "/poses.txt");
  std::vector<Eigen::VectorXd> poses;
  for (std::size_t at = 0; at + model.nq <= values.size(); at += model.nq)
    poses.push_back(Eigen::Map<const Eigen::VectorXd>(&values[at], model.nq));

  const auto forward = [&](const Eigen::VectorXd &q) {
    pin::forwardKinematics(model, data, q);
    pin::updateFramePlacement(model, data, tool);
  };
  if (std::string(arguments[2]) == "check") {
    const auto expected = numbers(folder + "/positions.txt");
    double worst = 0;
    for (std::size_t pose = 0; pose < poses.size(); ++pose) {
      forward(poses[pose]);
      for (int k = 0; k < 3; ++k)
        worst = std::max(worst,
                         std::abs(data.oMf[tool].translation()[k] - expected.at(3 * pose + k)));
    }
    std::printf("deviation pinocchio %.3g\n", worst);
    return 0;
  }
  volatile double sink = 0;
  pin::Data::Matrix6x jacobian(pin::Data::Matrix6x::Zero(6, model.nv));
  pin::Data::Matrix6x columns(pin::Data::Matrix6x::Zero(6, 6 * (model.njoints - 1)));
  time("forward", poses.size(), [&] {
    for (const auto &q : poses) {
      forward(q);
      sink = sink + data.oMf[tool].translation()[0];
    }
  });
  time("jacobian", poses.size(), [&] {
    for (const auto &q : poses) {
      pin::computeJointJacobians(model, data, q);
      pin::updateFramePlacement(model, data, tool);
      jacobian.setZero();
      pin::getFrameJacobian(model, data, tool, pin::LOCAL_WORLD_ALIGNED, jacobian);
      sink = sink + jacobian(0, 0);
    }
  });
  time("columns", poses.size(), [&] {
    for (const auto &q : poses) {
      forward(q);
      pin::computeFrameKinematicRegressor(model, data, tool, pin::LOCAL_WORLD_ALIGNED, columns);
      sink = sink + columns(0, 0);
    }
  });
}
