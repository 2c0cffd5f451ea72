// SPDX-License-Identifier: Apache-2.0
#include "dynamics/rigid_world.hpp"

#include "math/rotation.hpp"
#include "mebots/assert.hpp"
#include "mebots/error.hpp"
#include "scene/scene.hpp"

#include <fmt/format.h>
#include <ode/ode.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>

static_assert(sizeof(dReal) == sizeof(double), "ODE must be built with double precision");

namespace mebots::world {
namespace {

constexpr int kMaxContactsPerPair = 8;   // two boxes meet in at most eight points
constexpr int kMaxContactsPerMesh = 24;  // a box and triangles may have more

std::mutex ode_tables;

/// Initialises ODE for the whole process. ODE counts its users and frees its memory after the last user.
class OdeTables {
 public:
  OdeTables() {
    const std::lock_guard lock(ode_tables);
    dInitODE2(0);
  }
  ~OdeTables() {
    const std::lock_guard lock(ode_tables);
    dCloseODE();
  }
  OdeTables(const OdeTables&) = delete;
  OdeTables& operator=(const OdeTables&) = delete;
};

/// Fills ODE's tables when the library is loaded. The tables keep their values after ODE is closed.
[[maybe_unused]] const bool kTablesFilled = [] {
  const OdeTables tables;
  return true;
}();

/// Prepares ODE's data of the calling thread. Each thread that steps a world needs this. Further calls have no effect.
void prepare_thread() {
  if (dAllocateODEDataForThread(dAllocateMaskAll) == 0) throw Error("ODE has no memory for a thread's data");
}

dQuaternion& to_ode(const Eigen::Quaterniond& q, dQuaternion& target) {
  target[0] = q.w();
  target[1] = q.x();
  target[2] = q.y();
  target[3] = q.z();
  return target;
}

Eigen::Vector3d vector(const dReal* v) {
  return {v[0], v[1], v[2]};
}

/// A mesh for ODE's collision detection. Owns the numbers, because ODE keeps pointers to them.
class TriangleMesh {
 public:
  explicit TriangleMesh(const scene::Mesh& mesh) : data_(dGeomTriMeshDataCreate()) {
    for (const auto& point : mesh.points_m) places_.insert(places_.end(), {point.x(), point.y(), point.z()});
    for (const auto& triangle : mesh.triangles) {
      corners_.insert(corners_.end(), triangle.corners.begin(), triangle.corners.end());
    }
    dGeomTriMeshDataBuildDouble(data_, places_.data(), 3 * sizeof(double), static_cast<int>(mesh.points_m.size()),
                                corners_.data(), static_cast<int>(corners_.size()), 3 * sizeof(dTriIndex));
  }
  ~TriangleMesh() { dGeomTriMeshDataDestroy(data_); }
  TriangleMesh(const TriangleMesh&) = delete;
  TriangleMesh& operator=(const TriangleMesh&) = delete;

  dGeomID make_geom() const { return dCreateTriMesh(nullptr, data_, nullptr, nullptr, nullptr); }

 private:
  dTriMeshDataID data_;
  std::vector<double> places_;
  std::vector<dTriIndex> corners_;
};

/// Protects the working memory of ODE's routines for triangles. In Debian's build, all worlds of the process share this
/// memory.
std::mutex mesh_collisions;

}  // namespace

class RigidWorld::Impl {
 public:
  Impl(const scene::Scene& scene, std::span<const Eigen::Vector3d> body_sizes_m, std::size_t robots)
      : contact_(scene.contact), robots_(robots) {
    prepare_thread();
    world_ = dWorldCreate();
    // Gives each world its own list of jobs. By default, all worlds share one list, which only one thread may use at a
    // time.
    threading_ = dThreadingAllocateSelfThreadedImplementation();
    dWorldSetStepThreadingImplementation(world_, dThreadingImplementationGetFunctions(threading_), threading_);
    dWorldSetGravity(world_, 0.0, 0.0, -kGravity_m_per_s2);
    dWorldSetERP(world_, contact_.erp);
    dWorldSetCFM(world_, contact_.cfm);
    joints_ = dJointGroupCreate(0);

    drones_.resize(body_sizes_m.size());
    for (std::size_t i = 0; i < drones_.size(); ++i) make_drone(drones_[i], body_sizes_m[i]);
    obstacles_.push_back({dCreatePlane(nullptr, 0.0, 0.0, 1.0, 0.0), Touch::What::ground, 0, Eigen::Vector3d::Zero(),
                          nullptr, kMaxContactsPerPair});
    solids_ = scene::solids_of(scene);
    for (std::size_t i = 0; i < solids_.size(); ++i) add(solids_[i], i);
    if (robots > 0) parts_ = scene::solids_of(scene.robot.value());
    first_part_ = obstacles_.size();
    for (std::size_t i = 0; i < robots; ++i) make_robot(i);
    reserve();
  }

  ~Impl() {
    dJointGroupDestroy(joints_);
    for (const auto& obstacle : obstacles_) dGeomDestroy(obstacle.geom);
    for (const auto& drone : drones_) dGeomDestroy(drone.geom);
    dWorldDestroy(world_);
    dThreadingFreeImplementation(threading_);
  }

  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void set_mass(std::size_t drone, double mass_kg, const Eigen::Vector3d& inertia_kg_m2) {
    MEBOTS_ASSERT(mass_kg > 0 && (inertia_kg_m2.array() > 0).all());
    dMass mass;
    dMassSetParameters(&mass, mass_kg, 0.0, 0.0, 0.0, inertia_kg_m2.x(), inertia_kg_m2.y(), inertia_kg_m2.z(), 0.0, 0.0,
                       0.0);
    dBodySetMass(at(drone).body, &mass);
  }

  void place(std::size_t index, const RigidState& state, const Eigen::Vector3d& force_W,
             const Eigen::Vector3d& torque_B) {
    Drone& drone = at(index);
    check(drone, state, force_W, torque_B);
    drone.state = state;
    set_state(drone.body, state);
    dBodySetForce(drone.body, 0.0, 0.0, 0.0);
    dBodySetTorque(drone.body, 0.0, 0.0, 0.0);
    dBodyAddForce(drone.body, force_W.x(), force_W.y(), force_W.z());
    dBodyAddRelTorque(drone.body, torque_B.x(), torque_B.y(), torque_B.z());
  }

  void move_robot(std::size_t index, const RigidState& state) {
    MEBOTS_ASSERT(index < robots_.size());
    Robot& robot = robots_[index];
    check_motion(state, robot.name);
    robot.state = state;
    set_state(robot.body, state);
  }

  void step(double dt_s, std::int64_t time_ns) {
    MEBOTS_ASSERT(dt_s > 0);
    prepare_thread();
    collide(time_ns);
    if (dWorldStep(world_, dt_s) == 0) throw Error("ODE has no memory for a step");
    dJointGroupEmpty(joints_);
    dt_s_ = dt_s;
  }

  void find_touches(std::int64_t time_ns) {
    prepare_thread();
    collide(time_ns);
    dJointGroupEmpty(joints_);
  }

  RigidState state(std::size_t index) const {
    const dBodyID body = at(index).body;
    const dReal* q = dBodyGetQuaternion(body);
    RigidState state;
    state.p_WB_m = vector(dBodyGetPosition(body));
    state.q_WB = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
    state.v_WB_m_per_s = vector(dBodyGetLinearVel(body));
    state.w_WB_W_rad_per_s = vector(dBodyGetAngularVel(body));
    if (!state.is_finite()) {
      throw Error(
          fmt::format("the drone's motion is not finite after a step of {} s: a smaller physics.step may help", dt_s_));
    }
    return state;
  }

  const std::vector<Touch>& touches(std::size_t index) const { return at(index).touches; }

  bool robot_touches(std::size_t index) const {
    MEBOTS_ASSERT(index < robots_.size());
    return robots_[index].touches;
  }

 private:
  /// The greatest magnitude of a number that is passed to ODE. ODE multiplies several such numbers. If a product is not
  /// finite, ODE ends the process (dxNormalize4).
  static constexpr double kMost = 1e40;

  struct Drone {
    dBodyID body = nullptr;
    dGeomID geom = nullptr;
    double radius_m = 0.0;  ///< of a sphere around the box
    RigidState state;       ///< where it was placed
    std::vector<Touch> touches;
  };

  struct Robot {
    std::string name;
    dBodyID body = nullptr;
    RigidState state;
    bool touches = false;
  };

  /// The ground, an obstacle, a part of a gate, or a part of a robot.
  struct Obstacle {
    dGeomID geom;
    Touch::What what;
    std::size_t index;
    Eigen::Vector3d p_W_m;      ///< present position
    const scene::Solid* solid;  ///< null for the ground
    int most_contacts;
    dBodyID body = nullptr;  ///< of a moving obstacle or a robot
  };

  static void set_state(dBodyID body, const RigidState& state) {
    dQuaternion q;
    dBodySetPosition(body, state.p_WB_m.x(), state.p_WB_m.y(), state.p_WB_m.z());
    dBodySetQuaternion(body, to_ode(state.q_WB, q));
    dBodySetLinearVel(body, state.v_WB_m_per_s.x(), state.v_WB_m_per_s.y(), state.v_WB_m_per_s.z());
    dBodySetAngularVel(body, state.w_WB_W_rad_per_s.x(), state.w_WB_W_rad_per_s.y(), state.w_WB_W_rad_per_s.z());
  }

  /// `what` contains {}, which is replaced by the body's name.
  static void require_moderate(std::string_view what, std::string_view whose, double value) {
    if (value < kMost) return;
    throw Error(fmt::format("{} is {}, but must be below {}; check inputs and parameters",
                            fmt::format(fmt::runtime(what), whose), value, kMost));
  }

  static void check_motion(const RigidState& state, std::string_view whose) {
    if (!state.is_finite()) throw Error(fmt::format("the motion of {} is not finite; check its inputs", whose));
    require_moderate("a coordinate of {} [m]", whose, state.p_WB_m.cwiseAbs().maxCoeff());
    require_moderate("a velocity of {} [m/s]", whose, state.v_WB_m_per_s.cwiseAbs().maxCoeff());
    require_moderate("an angular velocity of {} [rad/s]", whose, state.w_WB_W_rad_per_s.cwiseAbs().maxCoeff());
  }

  static void check(const Drone& drone, const RigidState& state, const Eigen::Vector3d& force_W,
                    const Eigen::Vector3d& torque_B) {
    if (!state.is_finite() || !force_W.allFinite() || !torque_B.allFinite()) {
      throw Error("the drone's state or the forces on it are not finite: no step is possible from here");
    }
    dMass mass;
    dBodyGetMass(drone.body, &mass);
    constexpr std::string_view kDrone = "the drone";
    require_moderate("{}'s mass [kg]", kDrone, mass.mass);
    require_moderate("a moment of inertia of {} [kg.m2]", kDrone, std::max({mass.I[0], mass.I[5], mass.I[10]}));
    require_moderate("a force on {} [N]", kDrone, force_W.cwiseAbs().maxCoeff());
    require_moderate("a torque on {} [N.m]", kDrone, torque_B.cwiseAbs().maxCoeff());
    check_motion(state, kDrone);
  }

  const Drone& at(std::size_t index) const {
    MEBOTS_ASSERT(index < drones_.size());
    return drones_[index];
  }
  Drone& at(std::size_t index) {
    MEBOTS_ASSERT(index < drones_.size());
    return drones_[index];
  }

  void make_drone(Drone& drone, const Eigen::Vector3d& size_m) {
    drone.body = dBodyCreate(world_);
    dBodySetFiniteRotationMode(drone.body, 1);
    drone.geom = dCreateBox(nullptr, size_m.x(), size_m.y(), size_m.z());
    dGeomSetBody(drone.geom, drone.body);
    drone.radius_m = 0.5 * size_m.norm();
    greatest_radius_m_ = std::max(greatest_radius_m_, drone.radius_m);
  }

  /// Reserves memory for all contacts with the scene, and for simultaneous contacts with a few other drones.
  void reserve() {
    constexpr std::size_t kNeighbours = 8;
    std::size_t most = 0;
    for (const auto& obstacle : obstacles_) most += static_cast<std::size_t>(obstacle.most_contacts);
    most += std::min(drones_.size() - 1, kNeighbours) * kMaxContactsPerPair;
    for (auto& drone : drones_) drone.touches.reserve(most);
    pairs_.reserve(kNeighbours * drones_.size());
    for (std::size_t i = 0; i < drones_.size(); ++i) by_x_.push_back(i);
  }

  dGeomID make_geom(const scene::Solid& solid) {
    switch (solid.shape) {
      case scene::Solid::Shape::box:
        return dCreateBox(nullptr, solid.size_m.x(), solid.size_m.y(), solid.size_m.z());
      case scene::Solid::Shape::cylinder:
        return dCreateCylinder(nullptr, 0.5 * solid.size_m.x(), solid.size_m.z());
      case scene::Solid::Shape::mesh:
        return meshes_.emplace_back(*solid.mesh).make_geom();
    }
    throw Error(fmt::format("obstacle \"{}\" has no shape", solid.name));
  }

  static int most_contacts(const scene::Solid& solid) {
    return solid.shape == scene::Solid::Shape::mesh ? kMaxContactsPerMesh : kMaxContactsPerPair;
  }

  void make_robot(std::size_t index) {
    Robot& robot = robots_[index];
    robot.name = fmt::format("robot[{}]", index + 1);
    robot.body = dBodyCreate(world_);
    dBodySetKinematic(robot.body);
    for (const auto& part : parts_) {
      const dGeomID geom = make_geom(part);
      dQuaternion q;
      dGeomSetBody(geom, robot.body);
      dGeomSetOffsetPosition(geom, part.p_W_m.x(), part.p_W_m.y(), part.p_W_m.z());
      dGeomSetOffsetQuaternion(geom, to_ode(part.q_W, q));
      obstacles_.push_back({geom, Touch::What::robot, index, part.p_W_m, &part, most_contacts(part), robot.body});
    }
  }

  void add(const scene::Solid& solid, std::size_t index) {
    const bool of_gate = solid.gate != scene::Solid::kNoGate;
    Obstacle obstacle{make_geom(solid),
                      of_gate ? Touch::What::gate : Touch::What::obstacle,
                      of_gate ? solid.gate : index,
                      solid.p_W_m,
                      &solid,
                      most_contacts(solid)};
    if (solid.path.moves()) {
      obstacle.body = dBodyCreate(world_);
      dBodySetKinematic(obstacle.body);
      dGeomSetBody(obstacle.geom, obstacle.body);
    } else {
      dQuaternion q;
      dGeomSetPosition(obstacle.geom, solid.p_W_m.x(), solid.p_W_m.y(), solid.p_W_m.z());
      dGeomSetQuaternion(obstacle.geom, to_ode(solid.q_W, q));
    }
    obstacles_.push_back(obstacle);
  }

  /// Places a moving obstacle. Its body has the path's velocity, which forces do not change. For a part of a robot,
  /// only updates the position: move_robot() has placed the robot's body.
  void place(Obstacle& obstacle, std::int64_t time_ns) {
    if (obstacle.what == Touch::What::robot) {
      const RigidState& robot = robots_[obstacle.index].state;
      obstacle.p_W_m = robot.p_WB_m + robot.q_WB * obstacle.solid->p_W_m;
      return;
    }
    const scene::Displacement now = obstacle.solid->path.at(time_ns);
    obstacle.p_W_m = obstacle.solid->p_W_m + now.offset_W_m;
    dQuaternion q;
    dBodySetPosition(obstacle.body, obstacle.p_W_m.x(), obstacle.p_W_m.y(), obstacle.p_W_m.z());
    dBodySetQuaternion(obstacle.body, to_ode(yaw_rotation(now.turn_rad) * obstacle.solid->q_W, q));
    const Eigen::Vector3d& v = now.velocity_W_m_per_s;
    dBodySetLinearVel(obstacle.body, v.x(), v.y(), v.z());
    dBodySetAngularVel(obstacle.body, 0.0, 0.0, now.turn_rate_rad_per_s);
  }

  static bool is_near(const Obstacle& obstacle, const Drone& drone) {
    if (obstacle.what == Touch::What::ground) return drone.state.p_WB_m.z() < drone.radius_m;
    const double reach_m = drone.radius_m + obstacle.solid->radius_m;
    return (obstacle.p_W_m - drone.state.p_WB_m).squaredNorm() < reach_m * reach_m;
  }

  void collide(std::int64_t time_ns) {
    for (auto& obstacle : obstacles_) {
      if (obstacle.body != nullptr) place(obstacle, time_ns);
    }
    for (auto& robot : robots_) robot.touches = false;
    for (auto& drone : drones_) {
      drone.touches.clear();
      for (const auto& obstacle : obstacles_) {
        if (is_near(obstacle, drone)) collide(drone, obstacle);
      }
    }
    find_pairs();
    for (const auto& [a, b] : pairs_) collide(a, b);
    find_touches_of_robots();
  }

  /// Finds contacts of the robots' parts with obstacles, gates and parts of other robots. These contacts change no
  /// motion.
  void find_touches_of_robots() {
    for (std::size_t i = first_part_; i < obstacles_.size(); ++i) {
      for (std::size_t k = 1; k < i; ++k) {  // 0 is the ground
        if (k >= first_part_ && obstacles_[k].index == obstacles_[i].index) break;
        if (!meets(obstacles_[i], obstacles_[k])) continue;
        robots_[obstacles_[i].index].touches = true;
        if (k >= first_part_) robots_[obstacles_[k].index].touches = true;
      }
    }
  }

  static bool meets(const Obstacle& a, const Obstacle& b) {
    const double reach_m = a.solid->radius_m + b.solid->radius_m;
    if ((a.p_W_m - b.p_W_m).squaredNorm() >= reach_m * reach_m) return false;
    const bool has_mesh = a.solid->shape == scene::Solid::Shape::mesh || b.solid->shape == scene::Solid::Shape::mesh;
    const auto lock = has_mesh ? std::unique_lock(mesh_collisions) : std::unique_lock<std::mutex>();
    dContactGeom contact;
    return dCollide(a.geom, b.geom, 1, &contact, sizeof(dContactGeom)) > 0;
  }

  void collide(Drone& drone, const Obstacle& obstacle) {
    std::array<dContact, kMaxContactsPerMesh> contacts;
    // ODE's routines for triangles need a lock. Those for boxes, cylinders and planes use only the stack.
    const bool is_mesh = obstacle.solid != nullptr && obstacle.solid->shape == scene::Solid::Shape::mesh;
    const auto lock = is_mesh ? std::unique_lock(mesh_collisions) : std::unique_lock<std::mutex>();
    const int count = dCollide(drone.geom, obstacle.geom, obstacle.most_contacts, &contacts[0].geom, sizeof(dContact));
    MEBOTS_ASSERT(count >= 0 && count <= obstacle.most_contacts);
    for (int i = 0; i < count; ++i) {
      dContact& contact = contacts[static_cast<std::size_t>(i)];
      const Eigen::Vector3d p_W_m = vector(contact.geom.pos);
      Eigen::Vector3d velocity_W = velocity_at(drone, p_W_m);
      if (obstacle.body != nullptr) {
        dVector3 v;
        dBodyGetPointVel(obstacle.body, p_W_m.x(), p_W_m.y(), p_W_m.z(), v);
        velocity_W -= vector(v);
      }
      if (obstacle.what == Touch::What::robot) robots_[obstacle.index].touches = true;
      note(drone, {obstacle.what, obstacle.index}, contact, vector(contact.geom.normal), velocity_W);
      attach(contact, drone.body, obstacle.body);
    }
  }

  /// Finds the touches of two drones. ODE's normal points to the first drone.
  void collide(std::size_t first, std::size_t second) {
    Drone& a = drones_[first];
    Drone& b = drones_[second];
    std::array<dContact, kMaxContactsPerPair> contacts;
    const int count = dCollide(a.geom, b.geom, kMaxContactsPerPair, &contacts[0].geom, sizeof(dContact));
    for (int i = 0; i < count; ++i) {
      dContact& contact = contacts[static_cast<std::size_t>(i)];
      const Eigen::Vector3d p_W_m = vector(contact.geom.pos);
      const Eigen::Vector3d normal_W = vector(contact.geom.normal);
      const Eigen::Vector3d velocity_W = velocity_at(a, p_W_m) - velocity_at(b, p_W_m);
      note(a, {Touch::What::drone, second}, contact, normal_W, velocity_W);
      note(b, {Touch::What::drone, first}, contact, -normal_W, -velocity_W);
      attach(contact, a.body, b.body);
    }
  }

  /// Finds the pairs of drones whose spheres overlap, in rising order of their numbers. Sorts the drones along x, to
  /// compare only near drones. The order from the previous step is nearly correct.
  void find_pairs() {
    pairs_.clear();
    if (drones_.size() < 2) return;
    const auto x_of = [this](std::size_t i) { return drones_[i].state.p_WB_m.x(); };
    for (std::size_t k = 1; k < by_x_.size(); ++k) {
      for (std::size_t at = k; at > 0 && x_of(by_x_[at]) < x_of(by_x_[at - 1]); --at)
        std::swap(by_x_[at], by_x_[at - 1]);
    }
    for (std::size_t k = 0; k < by_x_.size(); ++k) {
      const Drone& a = drones_[by_x_[k]];
      for (std::size_t other = k + 1; other < by_x_.size(); ++other) {
        const Drone& b = drones_[by_x_[other]];
        if (b.state.p_WB_m.x() - a.state.p_WB_m.x() > a.radius_m + greatest_radius_m_) break;
        const double reach_m = a.radius_m + b.radius_m;
        if ((a.state.p_WB_m - b.state.p_WB_m).squaredNorm() >= reach_m * reach_m) continue;
        pairs_.emplace_back(std::min(by_x_[k], by_x_[other]), std::max(by_x_[k], by_x_[other]));
      }
    }
    std::sort(pairs_.begin(), pairs_.end());
  }

  static Eigen::Vector3d velocity_at(const Drone& drone, const Eigen::Vector3d& p_W_m) {
    return drone.state.v_WB_m_per_s + drone.state.w_WB_W_rad_per_s.cross(p_W_m - drone.state.p_WB_m);
  }

  struct Other {
    Touch::What what;
    std::size_t index;
  };

  static void note(Drone& drone, const Other& other, const dContact& contact, const Eigen::Vector3d& normal_W,
                   const Eigen::Vector3d& velocity_W) {
    drone.touches.push_back(
        {other.what, other.index, vector(contact.geom.pos), normal_W, contact.geom.depth, -velocity_W.dot(normal_W)});
  }

  void attach(dContact& contact, dBodyID body, dBodyID other) {
    contact.surface = {};
    // Makes mu a coefficient of friction. Without Approx1, mu would be a force.
    contact.surface.mode = dContactBounce | dContactSoftERP | dContactSoftCFM | dContactApprox1;
    contact.surface.mu = contact_.friction;
    contact.surface.bounce = contact_.bounce;
    contact.surface.bounce_vel = contact_.bounce_speed_m_per_s;
    contact.surface.soft_erp = contact_.soft_erp;
    contact.surface.soft_cfm = contact_.soft_cfm;
    dJointAttach(dJointCreateContact(world_, joints_, &contact), body, other);
  }

  OdeTables tables_;  // before all other members of ODE
  scene::Contact contact_;
  dWorldID world_ = nullptr;
  dThreadingImplementationID threading_ = nullptr;
  dJointGroupID joints_ = nullptr;
  double dt_s_ = 0.0;  // of the last step
  double greatest_radius_m_ = 0.0;
  std::vector<Drone> drones_;
  std::vector<std::size_t> by_x_;
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;
  std::vector<Robot> robots_;
  std::vector<scene::Solid> solids_;
  std::vector<scene::Solid> parts_;  // of each robot, in its frame
  std::deque<TriangleMesh> meshes_;
  std::vector<Obstacle> obstacles_;  // the ground, the solids, and the parts of all robots
  std::size_t first_part_ = 0;       // of the first robot, in obstacles_
};

RigidWorld::RigidWorld(const scene::Scene& scene, std::span<const Eigen::Vector3d> body_sizes_m, std::size_t robots)
    : impl_(std::make_unique<Impl>(scene, body_sizes_m, robots)) {}
RigidWorld::~RigidWorld() = default;

void RigidWorld::set_mass(std::size_t drone, double mass_kg, const Eigen::Vector3d& inertia_kg_m2) {
  impl_->set_mass(drone, mass_kg, inertia_kg_m2);
}

void RigidWorld::place(std::size_t drone, const RigidState& state, const Eigen::Vector3d& force_W_n,
                       const Eigen::Vector3d& torque_B_n_m) {
  impl_->place(drone, state, force_W_n, torque_B_n_m);
}

void RigidWorld::move_robot(std::size_t robot, const RigidState& state) {
  impl_->move_robot(robot, state);
}

void RigidWorld::step(double dt_s, std::int64_t time_ns) {
  impl_->step(dt_s, time_ns);
}

void RigidWorld::find_touches(std::int64_t time_ns) {
  impl_->find_touches(time_ns);
}

RigidState RigidWorld::state(std::size_t drone) const {
  return impl_->state(drone);
}

const std::vector<Touch>& RigidWorld::touches(std::size_t drone) const {
  return impl_->touches(drone);
}

bool RigidWorld::robot_touches(std::size_t robot) const {
  return impl_->robot_touches(robot);
}

}  // namespace mebots::world
