// Commands that bring the tip of a robot to the target of its file, or to a point, within the limits of the file.
//
//     reach ROBOT-FILE [X Y Z], in m

#include <cstdlib>
#include <iostream>

#include <whipcord.hpp>

int main(int argc, char **argv) {
    if (argc != 2 && argc != 5) {
        std::cerr << "usage: " << argv[0] << " ROBOT-FILE [X Y Z]\n";
        return 2;
    }
    try {
        const whipcord::Robot robot = whipcord::Robot::load(argv[1]);
        whipcord::Reach reach(robot);
        const whipcord::Reached reached =
            argc == 2 ? reach.target()
                      : reach.tip({std::atof(argv[2]), std::atof(argv[3]), std::atof(argv[4])});
        std::cout << (reached.is_reached() ? "reached" : "not reached") << ", "
                  << 1e3 * reached.position_miss << " mm from the target\n";
        for (const whipcord::Command &command : reached.commands) {
            switch (command.kind) {
            case WHIPCORD_COMMAND_KIND_TENSION:
                std::cout << robot.cable_name(command.number) << ": " << command.value << " N\n";
                break;
            case WHIPCORD_COMMAND_KIND_SHORTENING:
                std::cout << robot.cable_name(command.number) << ": " << 1e3 * command.value << " mm\n";
                break;
            case WHIPCORD_COMMAND_KIND_MOTOR:
                std::cout << robot.motor_name(command.number) << ": " << command.value << " rad or m\n";
                break;
            }
        }
        return reached.is_reached() ? 0 : 1;
    } catch (const whipcord::Error &error) {
        std::cerr << error.what() << '\n';
        return 1;
    }
}
