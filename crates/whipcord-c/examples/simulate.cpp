// The motion of a robot that is held by the first commands of its file and then let go: the place of the tip every 50 ms.
//
//     simulate ROBOT-FILE [SECONDS]

#include <cstdlib>
#include <iostream>
#include <vector>

#include <whipcord.hpp>

int main(int argc, char **argv) {
    if (argc < 2) {
        std::cerr << "usage: " << argv[0] << " ROBOT-FILE [SECONDS]\n";
        return 2;
    }
    const double end = argc > 2 ? std::atof(argv[2]) : 1.0;
    try {
        const whipcord::Robot robot = whipcord::Robot::load(argv[1]);
        whipcord::Simulation simulation(robot);
        simulation.set_tensions(std::vector<double>(robot.cable_count(), 0.0));
        std::cout << "t [s], x [mm], z [mm]\n";
        for (int step = 0; simulation.time() < end; ++step) {
            simulation.step(5e-3);
            if (step % 10 == 9) {
                const whipcord::Vec3 tip = simulation.tip().position;
                std::cout << simulation.time() << ", " << 1e3 * tip[0] << ", " << 1e3 * tip[2] << '\n';
            }
        }
        return 0;
    } catch (const whipcord::Error &error) {
        std::cerr << error.what() << '\n';
        return 1;
    }
}
