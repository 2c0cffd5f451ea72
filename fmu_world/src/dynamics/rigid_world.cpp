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

static_assert(sizeof(dReal) == sizeof(double), "ODE must be built with double precision");

namespace mebots::world {
namespace {

constexpr int kMaxContactsPerPair = 8;   // two boxes meet in at most eight points
constexpr int kMaxContactsPerMesh = 24;  // a box and triangles may have more

std::mutex ode_tables;

/// ODE's tables for the whole process. ODE counts its users and frees its memory after the last one.
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

/// Fills the tables once when the library is loaded. They keep their values when ODE is closed.
[[maybe_unused]] const bool kTablesFilled = [] {
  const OdeTables tables;
  return true;
}();

/// Each thread that steps needs its own data. No effect if it has them.
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

/// A mesh for ODE's collision. ODE keeps pointers to the numbers, so they stay here.
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

/// In Debian's build, ODE's routines for triangles share working memory between all worlds of a process.
std::mutex mesh_collisions;

}  // namespace

class RigidWorld::Impl {
 public:
  explicit Impl(const scene::Scene& scene) : contact_(scene.contact) {
    prepare_thread();
    world_ = dWorldCreate();
    // By default, all worlds share one list of jobs, which two threads must not use at the same time.
    threading_ = dThreadingAllocateSelfThreadedImplementation();
    dWorldSetStepThreadingImplementation(world_, dThreadingImplementationGetFunctions(threading_), threading_);
    dWorldSetGravity(world_, 0.0, 0.0, -kGravity_m_per_s2);
    dWorldSetERP(world_, contact_.erp);
    dWorldSetCFM(world_, contact_.cfm);
    joints_ = dJointGroupCreate(0);

    body_ = dBodyCreate(world_);
    dBodySetFiniteRotationMode(body_, 1);
    const Eigen::Vector3d& size = scene.drone.body_size_m;
    drone_ = dCreateBox(nullptr, size.x(), size.y(), size.z());
    dGeomSetBody(drone_, body_);
    drone_radius_m_ = 0.5 * size.norm();

    obstacles_.push_back({dCreatePlane(nullptr, 0.0, 0.0, 1.0, 0.0), Touch::What::ground, 0, Eigen::Vector3d::Zero(),
                          nullptr, kMaxContactsPerPair});
    solids_ = scene::solids_of(scene);
    for (std::size_t i = 0; i < solids_.size(); ++i) add(solids_[i], i);
    std::size_t most = 0;
    for (const auto& obstacle : obstacles_) most += static_cast<std::size_t>(obstacle.most_contacts);
    touches_.reserve(most);
  }

  ~Impl() {
    dJointGroupDestroy(joints_);
    for (const auto& obstacle : obstacles_) dGeomDestroy(obstacle.geom);
    dGeomDestroy(drone_);
    dWorldDestroy(world_);
    dThreadingFreeImplementation(threading_);
  }

  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  void set_mass(double mass_kg, const Eigen::Vector3d& inertia_kg_m2) {
    MEBOTS_ASSERT(mass_kg > 0 && (inertia_kg_m2.array() > 0).all());
    dMass mass;
    dMassSetParameters(&mass, mass_kg, 0.0, 0.0, 0.0, inertia_kg_m2.x(), inertia_kg_m2.y(), inertia_kg_m2.z(), 0.0, 0.0,
                       0.0);
    dBodySetMass(body_, &mass);
  }

  const std::vector<Touch>& step(RigidState& state, const Eigen::Vector3d& force_W, const Eigen::Vector3d& torque_B,
                                 double dt_s, std::int64_t time_ns) {
    prepare_thread();
    if (!state.is_finite() || !force_W.allFinite() || !torque_B.allFinite()) {
      throw Error("the drone's state or the forces on it are not finite: no step is possible from here");
    }
    dMass mass;
    dBodyGetMass(body_, &mass);
    require_moderate("the drone's mass [kg]", mass.mass);
    require_moderate("a moment of inertia of the drone [kg.m2]", std::max({mass.I[0], mass.I[5], mass.I[10]}));
    require_moderate("a force on the drone [N]", force_W.cwiseAbs().maxCoeff());
    require_moderate("a torque on the drone [N.m]", torque_B.cwiseAbs().maxCoeff());
    require_moderate("a coordinate of the drone [m]", state.p_WB_m.cwiseAbs().maxCoeff());
    require_moderate("a velocity of the drone [m/s]", state.v_WB_m_per_s.cwiseAbs().maxCoeff());
    require_moderate("an angular velocity of the drone [rad/s]", state.w_WB_W_rad_per_s.cwiseAbs().maxCoeff());
    MEBOTS_ASSERT(dt_s > 0);
    load(state, time_ns);
    collide(state);
    dBodyAddForce(body_, force_W.x(), force_W.y(), force_W.z());
    dBodyAddRelTorque(body_, torque_B.x(), torque_B.y(), torque_B.z());
    if (dWorldStep(world_, dt_s) == 0) throw Error("ODE has no memory for a step");
    dJointGroupEmpty(joints_);
    unload(state);
    if (!state.is_finite()) {
      throw Error(
          fmt::format("the drone's motion is not finite after a step of {} s: a smaller physics.step may help", dt_s));
    }
    return touches_;
  }

  const std::vector<Touch>& touches_at(const RigidState& state, std::int64_t time_ns) {
    prepare_thread();
    load(state, time_ns);
    collide(state);
    dJointGroupEmpty(joints_);
    return touches_;
  }

 private:
  /// ODE multiplies a few such numbers. If a product is not finite, ODE ends the process (dxNormalize4).
  static constexpr double kMost = 1e40;

  static void require_moderate(const char* what, double value) {
    if (value < kMost) return;
    throw Error(fmt::format("{} is {}, and a step is possible below {} only; look at inputs and parameters", what,
                            value, kMost));
  }

  struct Obstacle {
    dGeomID geom;
    Touch::What what;
    std::size_t index;
    Eigen::Vector3d p_W_m;      ///< present position
    const scene::Solid* solid;  ///< null for the ground
    int most_contacts;
    dBodyID body = nullptr;  ///< of a moving obstacle
  };

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

  void add(const scene::Solid& solid, std::size_t index) {
    const bool of_gate = solid.gate != scene::Solid::kNoGate;
    const bool is_mesh = solid.shape == scene::Solid::Shape::mesh;
    Obstacle obstacle{make_geom(solid),
                      of_gate ? Touch::What::gate : Touch::What::obstacle,
                      of_gate ? solid.gate : index,
                      solid.p_W_m,
                      &solid,
                      is_mesh ? kMaxContactsPerMesh : kMaxContactsPerPair};
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

  /// A moving obstacle has a body with the path's velocity, which no force changes.
  void place(Obstacle& obstacle, std::int64_t time_ns) {
    const scene::Displacement now = obstacle.solid->path.at(time_ns);
    obstacle.p_W_m = obstacle.solid->p_W_m + now.offset_W_m;
    dQuaternion q;
    dBodySetPosition(obstacle.body, obstacle.p_W_m.x(), obstacle.p_W_m.y(), obstacle.p_W_m.z());
    dBodySetQuaternion(obstacle.body, to_ode(yaw_rotation(now.turn_rad) * obstacle.solid->q_W, q));
    const Eigen::Vector3d& v = now.velocity_W_m_per_s;
    dBodySetLinearVel(obstacle.body, v.x(), v.y(), v.z());
    dBodySetAngularVel(obstacle.body, 0.0, 0.0, now.turn_rate_rad_per_s);
  }

  void load(const RigidState& state, std::int64_t time_ns) {
    for (auto& obstacle : obstacles_) {
      if (obstacle.body != nullptr) place(obstacle, time_ns);
    }
    dQuaternion q;
    dBodySetPosition(body_, state.p_WB_m.x(), state.p_WB_m.y(), state.p_WB_m.z());
    dBodySetQuaternion(body_, to_ode(state.q_WB, q));
    dBodySetLinearVel(body_, state.v_WB_m_per_s.x(), state.v_WB_m_per_s.y(), state.v_WB_m_per_s.z());
    dBodySetAngularVel(body_, state.w_WB_W_rad_per_s.x(), state.w_WB_W_rad_per_s.y(), state.w_WB_W_rad_per_s.z());
    dBodySetForce(body_, 0.0, 0.0, 0.0);
    dBodySetTorque(body_, 0.0, 0.0, 0.0);
  }

  void unload(RigidState& state) const {
    const dReal* q = dBodyGetQuaternion(body_);
    state.p_WB_m = vector(dBodyGetPosition(body_));
    state.q_WB = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
    state.v_WB_m_per_s = vector(dBodyGetLinearVel(body_));
    state.w_WB_W_rad_per_s = vector(dBodyGetAngularVel(body_));
  }

  bool is_near(const Obstacle& obstacle, const Eigen::Vector3d& p_W_m) const {
    if (obstacle.what == Touch::What::ground) return p_W_m.z() < drone_radius_m_;
    const double reach_m = drone_radius_m_ + obstacle.solid->radius_m;
    return (obstacle.p_W_m - p_W_m).squaredNorm() < reach_m * reach_m;
  }

  void collide(const RigidState& state) {
    touches_.clear();
    std::array<dContact, kMaxContactsPerMesh> contacts;
    for (const auto& obstacle : obstacles_) {
      if (!is_near(obstacle, state.p_WB_m)) continue;
      // ODE's routines for boxes, cylinders and planes only use the stack, so instances in several threads need no
      // lock. Those for triangles need one.
      const bool is_mesh = obstacle.solid != nullptr && obstacle.solid->shape == scene::Solid::Shape::mesh;
      const auto lock = is_mesh ? std::unique_lock(mesh_collisions) : std::unique_lock<std::mutex>();
      const int count = dCollide(drone_, obstacle.geom, obstacle.most_contacts, &contacts[0].geom, sizeof(dContact));
      MEBOTS_ASSERT(count >= 0 && count <= obstacle.most_contacts);
      for (int i = 0; i < count; ++i) attach(contacts[static_cast<std::size_t>(i)], obstacle, state);
    }
  }

  void attach(dContact& contact, const Obstacle& obstacle, const RigidState& state) {
    const Eigen::Vector3d p_W_m = vector(contact.geom.pos);
    const Eigen::Vector3d normal_W = vector(contact.geom.normal);
    Eigen::Vector3d velocity_W = state.v_WB_m_per_s + state.w_WB_W_rad_per_s.cross(p_W_m - state.p_WB_m);
    if (obstacle.body != nullptr) {
      dVector3 v;
      dBodyGetPointVel(obstacle.body, p_W_m.x(), p_W_m.y(), p_W_m.z(), v);
      velocity_W -= vector(v);
    }
    MEBOTS_ASSERT(touches_.size() < touches_.capacity());
    touches_.push_back({obstacle.what, obstacle.index, p_W_m, normal_W, contact.geom.depth, -velocity_W.dot(normal_W)});

    contact.surface = {};
    // Approx1 makes mu a coefficient of friction; without it, mu is a force.
    contact.surface.mode = dContactBounce | dContactSoftERP | dContactSoftCFM | dContactApprox1;
    contact.surface.mu = contact_.friction;
    contact.surface.bounce = contact_.bounce;
    contact.surface.bounce_vel = contact_.bounce_speed_m_per_s;
    contact.surface.soft_erp = contact_.soft_erp;
    contact.surface.soft_cfm = contact_.soft_cfm;
    dJointAttach(dJointCreateContact(world_, joints_, &contact), body_, obstacle.body);
  }

  OdeTables tables_;  // before all other members of ODE
  scene::Contact contact_;
  dWorldID world_ = nullptr;
  dThreadingImplementationID threading_ = nullptr;
  dJointGroupID joints_ = nullptr;
  dBodyID body_ = nullptr;
  dGeomID drone_ = nullptr;
  double drone_radius_m_ = 0.0;
  std::vector<scene::Solid> solids_;
  std::deque<TriangleMesh> meshes_;
  std::vector<Obstacle> obstacles_;
  std::vector<Touch> touches_;
};

RigidWorld::RigidWorld(const scene::Scene& scene) : impl_(std::make_unique<Impl>(scene)) {}
RigidWorld::~RigidWorld() = default;

void RigidWorld::set_mass(double mass_kg, const Eigen::Vector3d& inertia_kg_m2) {
  impl_->set_mass(mass_kg, inertia_kg_m2);
}

const std::vector<Touch>& RigidWorld::step(RigidState& state, const Eigen::Vector3d& force_W_n,
                                           const Eigen::Vector3d& torque_B_n_m, double dt_s, std::int64_t time_ns) {
  return impl_->step(state, force_W_n, torque_B_n_m, dt_s, time_ns);
}

const std::vector<Touch>& RigidWorld::touches_at(const RigidState& state, std::int64_t time_ns) {
  return impl_->touches_at(state, time_ns);
}

}  // namespace mebots::world
