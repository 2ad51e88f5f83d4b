// The C++ header: moves, errors, and what the objects give. Fails by its exit status.

#include <algorithm>
#include <cmath>
#include <iostream>
#include <limits>
#include <type_traits>
#include <utility>

#include <whipcord.hpp>

static_assert(!std::is_copy_constructible_v<whipcord::Robot>);
static_assert(!std::is_copy_constructible_v<whipcord::Solver>);
static_assert(!std::is_copy_assignable_v<whipcord::Reach>);
static_assert(std::is_nothrow_move_constructible_v<whipcord::Simulation>);

namespace {

int failures = 0;

void expect(bool holds, const char *what) {
    if (!holds) {
        std::cerr << "does not hold: " << what << '\n';
        ++failures;
    }
}

template <class Call> void expect_error(whipcord_status_t status, Call call, const char *what) {
    try {
        call();
        expect(false, what);
    } catch (const whipcord::Error &error) {
        expect(error.status() == status && error.what()[0] != '\0', what);
    }
}

} // namespace

int main(int argc, char **argv) {
    if (argc != 2) {
        return 2;
    }
    expect(!whipcord::version().empty(), "there is a version");
    const whipcord::Robot robot = whipcord::Robot::load(argv[1]);
    whipcord::Solver first(robot);
    expect_error(WHIPCORD_STATUS_UNAVAILABLE, [&] { first.tip(); }, "no answer before a solve");
    whipcord::Solver solver = std::move(first);
    expect_error(WHIPCORD_STATUS_NULL_POINTER, [&] { first.solve(); }, "a solver that was moved from");
    expect(solver.solve(), "the case of the file is solved");
    expect(solver.disks().size() == robot.disk_count(), "a pose for each disk");
    expect(solver.disks().back().position == solver.tip().position, "the last disk is at the tip");
    expect(solver.diagnostics().stability == WHIPCORD_STABILITY_STABLE, "the answer is stable");
    expect(solver.lengths().size() == robot.cable_count(), "a length for each cable");
    expect(solver.slack() == std::vector<std::uint8_t>(robot.cable_count(), 0), "no cable is slack");

    // The Jacobian tells where the tip goes.
    std::vector<double> tensions = solver.tensions();
    const whipcord::Pose before = solver.tip();
    const std::vector<double> jacobian = solver.tip_jacobian();
    tensions[0] += 1e-3;
    solver.set_tensions(tensions);
    expect(solver.solve(), "a neighbouring case is solved");
    const double moved = solver.tip().position[0] - before.position[0];
    expect(std::abs(moved - 1e-3 * jacobian[0]) < 1e-3 * std::abs(moved) + 1e-9, "it is that of the tip");

    // Each cable in its own way.
    std::vector<whipcord::CableCommand> commands;
    const std::vector<double> held = solver.lengths();
    for (const double tension : solver.tensions()) {
        commands.push_back(whipcord::CableCommand::tension(tension));
    }
    solver.set_commands(commands);
    // From the answer before, to the residual of the iteration.
    const auto near = [](double a, double b) { return std::abs(a - b) < 1e-9; };
    const bool is_solved = solver.solve();
    const std::vector<double> again = solver.lengths();
    expect(is_solved && std::equal(again.begin(), again.end(), held.begin(), held.end(), near), "the same tensions give the same lengths");
    commands[0] = whipcord::CableCommand::shortening(2e-3);
    solver.set_commands(commands);
    expect(solver.solve() && solver.lengths()[0] != held[0], "one cable is driven by its length");
    solver.set_tolerance(1e-9);
    expect(solver.solve(), "a smaller tolerance is met");
    expect_error(WHIPCORD_STATUS_INVALID_ARGUMENT, [&] { solver.set_tolerance(0.0); }, "no tolerance");

    const double nan = std::numeric_limits<double>::quiet_NaN();
    expect_error(WHIPCORD_STATUS_INVALID_ARGUMENT, [&] { solver.set_tip_load({nan, 0.0, 0.0}); }, "NaN");
    expect_error(WHIPCORD_STATUS_WRONG_LENGTH, [&] { solver.set_tensions({1.0}); }, "one tension");
    expect_error(WHIPCORD_STATUS_WRONG_LENGTH, [&] { solver.set_motors({1.0}); }, "a motor");
    expect_error(WHIPCORD_STATUS_FILE, [] { whipcord::Robot::parse("[backbone"); }, "no TOML");
    expect_error(WHIPCORD_STATUS_FILE, [] { whipcord::Robot::load("nothing.toml"); }, "no file");
    expect_error(WHIPCORD_STATUS_INVALID_ARGUMENT, [&] { whipcord::Solver(robot, "none"); }, "no model");
    expect_error(WHIPCORD_STATUS_UNAVAILABLE, [&] { whipcord::Reach(robot).target(); }, "no target");

    whipcord::Reach reach(robot);
    solver.set_tolerance(1e-6);
    const whipcord::Reached reached = reach.tip(before.position);
    expect(reached.is_reached() && reached.commands.size() == robot.cable_count(), "its own tip is reached");
    solver.reset();
    expect(solver.solve() && solver.tip().position == before.position, "a reset leads to the first answer");
    if (failures == 0) {
        std::cout << "the C++ header holds what it says\n";
    }
    return failures == 0 ? 0 : 1;
}
