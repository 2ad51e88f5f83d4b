/**
 * Whipcord: statics and motion of cable-driven continuum robots, for C++17.
 *
 * A thin layer on whipcord.h: objects that can be moved but not copied own the handles, and what fails throws whipcord::Error. All numbers are
 * in SI units. An object is of one thread at a time. An object that was moved from may only be assigned to or destroyed; any other use throws.
 */
#ifndef WHIPCORD_HPP
#define WHIPCORD_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "whipcord.h"

namespace whipcord {

/** Why a call failed. */
class Error : public std::runtime_error {
public:
    Error(whipcord_status_t status, const std::string &message)
        : std::runtime_error(message), status_(status) {}

    whipcord_status_t status() const noexcept { return status_; }

private:
    whipcord_status_t status_;
};

/** A point or a direction. */
using Vec3 = std::array<double, 3>;

/** A pose: position in m, and quaternion (w, x, y, z). */
struct Pose {
    Vec3 position{};
    std::array<double, 4> rotation{1.0, 0.0, 0.0, 0.0};
};

/** The command of a cable: its tension in N, or its shortening in m. */
struct CableCommand {
    static CableCommand tension(double value) { return {value, false}; }
    static CableCommand shortening(double value) { return {value, true}; }

    double value;
    bool by_shortening;
};

/** One command of an inverse problem: what it is, the number of its cable or motor, and its value in N, m or rad. */
struct Command {
    whipcord_command_kind_t kind;
    std::size_t number;
    double value;
};

/** The answer to an inverse problem. */
struct Reached {
    whipcord_reach_outcome_t outcome;
    double position_miss;
    double angle_miss;
    Pose tip;
    std::size_t solves;
    std::vector<Command> commands;

    bool is_reached() const noexcept { return outcome == WHIPCORD_REACH_OUTCOME_REACHED; }
};

namespace detail {

inline void check(whipcord_status_t status) {
    if (status != WHIPCORD_STATUS_OK) {
        throw Error(status, whipcord_last_error());
    }
}

inline Pose pose(const double *values) {
    return {{values[0], values[1], values[2]}, {values[3], values[4], values[5], values[6]}};
}

inline std::vector<Pose> poses(const std::vector<double> &values) {
    std::vector<Pose> all;
    all.reserve(values.size() / 7);
    for (std::size_t i = 0; i + 7 <= values.size(); i += 7) {
        all.push_back(pose(values.data() + i));
    }
    return all;
}

/** Values and flags as whipcord.h takes them. */
inline std::pair<std::vector<double>, std::vector<std::uint8_t>>
split(const std::vector<CableCommand> &commands) {
    std::pair<std::vector<double>, std::vector<std::uint8_t>> arrays;
    for (const CableCommand &command : commands) {
        arrays.first.push_back(command.value);
        arrays.second.push_back(command.by_shortening ? 1 : 0);
    }
    return arrays;
}

/** Frees a handle as its type is freed. */
struct Free {
    void operator()(whipcord_robot_t *handle) const noexcept { whipcord_robot_free(handle); }
    void operator()(whipcord_solver_t *handle) const noexcept { whipcord_solver_free(handle); }
    void operator()(whipcord_reach_t *handle) const noexcept { whipcord_reach_free(handle); }
    void operator()(whipcord_simulation_t *handle) const noexcept {
        whipcord_simulation_free(handle);
    }
};

template <class Handle> using Owned = std::unique_ptr<Handle, Free>;

inline std::string text(const char *pointer) { return pointer ? std::string(pointer) : std::string(); }

} // namespace detail

/** The version of the library that is loaded. */
inline std::string version() { return whipcord_version(); }

/** A robot with what is asked of it, from a robot file. */
class Robot {
public:
    /** Reads a robot file, and the files that it names. */
    static Robot load(const std::string &path) {
        whipcord_robot_t *handle = nullptr;
        detail::check(whipcord_robot_load(path.c_str(), &handle));
        return Robot(handle);
    }

    /** Reads the text of a robot file; `name` stands for it in messages. */
    static Robot parse(const std::string &content, const std::string &name = "robot.toml") {
        whipcord_robot_t *handle = nullptr;
        detail::check(whipcord_robot_parse(content.c_str(), name.c_str(), &handle));
        return Robot(handle);
    }

    std::string title() const { return detail::text(whipcord_robot_title(get())); }
    std::size_t cable_count() const noexcept { return whipcord_robot_cable_count(get()); }
    std::size_t disk_count() const noexcept { return whipcord_robot_disk_count(get()); }
    std::size_t motor_count() const noexcept { return whipcord_robot_motor_count(get()); }
    /** Length of the backbone in m. */
    double length() const noexcept { return whipcord_robot_length(get()); }
    /** Name of a cable; empty where there is none of this number. */
    std::string cable_name(std::size_t i) const {
        return detail::text(whipcord_robot_cable_name(get(), i));
    }
    /** Name of a motor; empty where there is none of this number. */
    std::string motor_name(std::size_t i) const {
        return detail::text(whipcord_robot_motor_name(get(), i));
    }

    const whipcord_robot_t *get() const noexcept { return handle_.get(); }

private:
    explicit Robot(whipcord_robot_t *handle) : handle_(handle) {}
    detail::Owned<whipcord_robot_t> handle_;
};

/** A model of a robot with its commands and its last solution, from which the next solve starts. */
class Solver {
public:
    explicit Solver(const Robot &robot, const std::string &model = "cosserat")
        : cables_(robot.cable_count()), disks_(robot.disk_count()) {
        whipcord_solver_t *handle = nullptr;
        detail::check(whipcord_solver_new(robot.get(), model.c_str(), &handle));
        handle_.reset(handle);
    }

    void reset() { detail::check(whipcord_solver_reset(get())); }
    void set_budget(std::size_t iterations, std::size_t integration_steps) {
        detail::check(whipcord_solver_set_budget(get(), iterations, integration_steps));
    }
    /** Estimated error of positions and lengths as a part of the length of the backbone. */
    void set_tolerance(double tolerance) {
        detail::check(whipcord_solver_set_tolerance(get(), tolerance));
    }
    void set_tensions(const std::vector<double> &tensions) {
        detail::check(whipcord_solver_set_tensions(get(), tensions.data(), tensions.size()));
    }
    void set_shortenings(const std::vector<double> &shortenings) {
        detail::check(whipcord_solver_set_shortenings(get(), shortenings.data(), shortenings.size()));
    }
    /** Commands each cable in its own way. */
    void set_commands(const std::vector<CableCommand> &commands) {
        const auto [values, by_shortening] = detail::split(commands);
        detail::check(whipcord_solver_set_commands(get(), values.data(), by_shortening.data(),
                                                   values.size()));
    }
    void set_motors(const std::vector<double> &commands) {
        detail::check(whipcord_solver_set_motors(get(), commands.data(), commands.size()));
    }
    void set_tip_load(const Vec3 &force, const Vec3 &moment = Vec3{}) {
        detail::check(whipcord_solver_set_tip_load(get(), force.data(), moment.data()));
    }

    /** Solves. False where the budget is spent: the solution is then the best shape so far. */
    bool solve() {
        const whipcord_status_t status = whipcord_solver_solve(get());
        if (status == WHIPCORD_STATUS_BUDGET_SPENT) {
            return false;
        }
        detail::check(status);
        return true;
    }

    Pose tip() const {
        std::array<double, 7> values{};
        detail::check(whipcord_solver_tip_pose(get(), values.data()));
        return detail::pose(values.data());
    }
    std::vector<Pose> disks() const {
        std::vector<double> values(7 * disks_);
        detail::check(whipcord_solver_disk_poses(get(), values.data(), values.size()));
        return detail::poses(values);
    }
    std::vector<double> tensions() const {
        std::vector<double> values(cables_);
        detail::check(whipcord_solver_tensions(get(), values.data(), values.size()));
        return values;
    }
    std::vector<double> lengths() const {
        std::vector<double> values(cables_);
        detail::check(whipcord_solver_lengths(get(), values.data(), values.size()));
        return values;
    }
    /** For each cable 1 where it is slack, else 0. */
    std::vector<std::uint8_t> slack() const {
        std::vector<std::uint8_t> values(cables_);
        detail::check(whipcord_solver_slack(get(), values.data(), values.size()));
        return values;
    }
    whipcord_diagnostics_t diagnostics() const {
        whipcord_diagnostics_t values{};
        detail::check(whipcord_solver_diagnostics(get(), &values));
        return values;
    }
    /** 6 rows of one column for each cable, row by row: velocity and angular velocity of the tip for each N or m of the commands. */
    std::vector<double> tip_jacobian() {
        std::vector<double> values(6 * cables_);
        detail::check(whipcord_solver_tip_jacobian(get(), values.data(), values.size()));
        return values;
    }

    /** For calls of whipcord.h, such as those that write to arrays of the caller. */
    whipcord_solver_t *get() const noexcept { return handle_.get(); }

private:
    std::size_t cables_;
    std::size_t disks_;
    detail::Owned<whipcord_solver_t> handle_;
};

/** Finds the commands for targets, within the limits of the robot file. */
class Reach {
public:
    explicit Reach(const Robot &robot, const std::string &model = "cosserat") {
        whipcord_reach_t *handle = nullptr;
        detail::check(whipcord_reach_new(robot.get(), model.c_str(), &handle));
        handle_.reset(handle);
    }

    /** Commands for a point of the tip, in m. */
    Reached tip(const Vec3 &point) {
        whipcord_reach_result_t result{};
        detail::check(whipcord_reach_tip(get(), point.data(), &result));
        return reached(result);
    }
    /** Commands for a pose of the tip. */
    Reached pose(const Pose &pose) {
        const auto &[x, y, z] = pose.position;
        const auto &[w, a, b, c] = pose.rotation;
        const std::array<double, 7> values{x, y, z, w, a, b, c};
        whipcord_reach_result_t result{};
        detail::check(whipcord_reach_pose(get(), values.data(), &result));
        return reached(result);
    }
    /** Commands for the target of the file. */
    Reached target() {
        whipcord_reach_result_t result{};
        detail::check(whipcord_reach_target(get(), &result));
        return reached(result);
    }

    whipcord_reach_t *get() const noexcept { return handle_.get(); }

private:
    Reached reached(const whipcord_reach_result_t &result) const {
        std::vector<double> values(whipcord_reach_command_count(get()));
        detail::check(whipcord_reach_commands(get(), values.data(), values.size()));
        Reached all{result.outcome, result.position_miss, result.angle_miss, detail::pose(result.tip),
                    result.solves,  {}};
        for (std::size_t i = 0; i < values.size(); ++i) {
            Command command{};
            detail::check(whipcord_reach_command(get(), i, &command.kind, &command.number));
            command.value = values[i];
            all.commands.push_back(command);
        }
        return all;
    }

    detail::Owned<whipcord_reach_t> handle_;
};

/** A robot in motion. */
class Simulation {
public:
    explicit Simulation(const Robot &robot) : cables_(robot.cable_count()) {
        whipcord_simulation_t *handle = nullptr;
        detail::check(whipcord_simulation_new(robot.get(), &handle));
        handle_.reset(handle);
    }

    void set_tensions(const std::vector<double> &tensions) {
        detail::check(whipcord_simulation_set_tensions(get(), tensions.data(), tensions.size()));
    }
    void set_shortenings(const std::vector<double> &shortenings) {
        detail::check(
            whipcord_simulation_set_shortenings(get(), shortenings.data(), shortenings.size()));
    }
    /** Commands each cable in its own way from now on. */
    void set_commands(const std::vector<CableCommand> &commands) {
        const auto [values, by_shortening] = detail::split(commands);
        detail::check(whipcord_simulation_set_commands(get(), values.data(), by_shortening.data(),
                                                       values.size()));
    }
    void set_motors(const std::vector<double> &commands) {
        detail::check(whipcord_simulation_set_motors(get(), commands.data(), commands.size()));
    }

    /** Takes a step of `dt` seconds. */
    void step(double dt) { detail::check(whipcord_simulation_step(get(), dt)); }

    double time() const noexcept { return whipcord_simulation_time(get()); }
    Pose tip() const {
        std::array<double, 7> values{};
        detail::check(whipcord_simulation_tip_pose(get(), values.data()));
        return detail::pose(values.data());
    }
    std::vector<Pose> nodes() const {
        std::vector<double> values(7 * whipcord_simulation_node_count(get()));
        detail::check(whipcord_simulation_node_poses(get(), values.data(), values.size()));
        return detail::poses(values);
    }
    std::vector<double> tensions() const {
        std::vector<double> values(cables_);
        detail::check(whipcord_simulation_tensions(get(), values.data(), values.size()));
        return values;
    }
    std::vector<double> lengths() const {
        std::vector<double> values(cables_);
        detail::check(whipcord_simulation_lengths(get(), values.data(), values.size()));
        return values;
    }

    whipcord_simulation_t *get() const noexcept { return handle_.get(); }

private:
    std::size_t cables_;
    detail::Owned<whipcord_simulation_t> handle_;
};

} // namespace whipcord

#endif
