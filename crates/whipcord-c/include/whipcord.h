/**
 * Whipcord: statics and motion of cable-driven continuum robots, for C.
 *
 * All numbers are in SI units. Handles are of one thread at a time; different handles may be used at the same time. A function that
 * returns a status writes nothing where it fails, and leaves a message in whipcord_last_error. A handle that is NULL is an error and
 * never followed; one that was freed, or an array that is shorter than said, cannot be noticed.
 *
 * This file is generated from crates/whipcord-c.
 */

#ifndef WHIPCORD_H
#define WHIPCORD_H

#include <stddef.h>
#include <stdint.h>

/**
 * Version of the binary interface, the number in the name of the shared library. It changes when a program must be compiled anew.
 */
#define WHIPCORD_ABI_VERSION 1

/**
 * How a call ended.
 */
typedef enum {
    /**
     * As asked.
     */
    WHIPCORD_STATUS_OK = 0,
    /**
     * A pointer that must not be NULL is.
     */
    WHIPCORD_STATUS_NULL_POINTER = 1,
    /**
     * A number or a name that cannot be, such as a NaN, a negative tension or a model that there is not.
     */
    WHIPCORD_STATUS_INVALID_ARGUMENT = 2,
    /**
     * An array has not the length that is needed.
     */
    WHIPCORD_STATUS_WRONG_LENGTH = 3,
    /**
     * A text is not UTF-8.
     */
    WHIPCORD_STATUS_NOT_UTF8 = 4,
    /**
     * The robot file cannot be read or used: the message has the line and the remedy.
     */
    WHIPCORD_STATUS_FILE = 5,
    /**
     * The model or the motion cannot take the robot or the case.
     */
    WHIPCORD_STATUS_REFUSED = 6,
    /**
     * No solution was found; the one before, if there was one, is kept.
     */
    WHIPCORD_STATUS_NO_SOLUTION = 7,
    /**
     * The budget is spent. The solution is the best shape so far.
     */
    WHIPCORD_STATUS_BUDGET_SPENT = 8,
    /**
     * What is asked for is not there: nothing has been solved yet, or the model does not compute it.
     */
    WHIPCORD_STATUS_UNAVAILABLE = 9,
    /**
     * An error in the library. The handle must be freed and not be used otherwise.
     */
    WHIPCORD_STATUS_INTERNAL = 10,
} whipcord_status_t;

/**
 * Whether an equilibrium is stable.
 */
typedef enum {
    /**
     * Not known: the model has no energy, or it is not determined.
     */
    WHIPCORD_STABILITY_UNKNOWN = 0,
    /**
     * The robot comes back after a small disturbance.
     */
    WHIPCORD_STABILITY_STABLE = 1,
    /**
     * It does not.
     */
    WHIPCORD_STABILITY_UNSTABLE = 2,
} whipcord_stability_t;

/**
 * What a command is.
 */
typedef enum {
    /**
     * The tension of a cable in N.
     */
    WHIPCORD_COMMAND_KIND_TENSION = 0,
    /**
     * The shortening of a cable in m.
     */
    WHIPCORD_COMMAND_KIND_SHORTENING = 1,
    /**
     * A motor: its angle in rad, or its travel in m.
     */
    WHIPCORD_COMMAND_KIND_MOTOR = 2,
} whipcord_command_kind_t;

/**
 * What became of a target.
 */
typedef enum {
    /**
     * The robot is there within tolerance and limits, in a stable equilibrium.
     */
    WHIPCORD_REACH_OUTCOME_REACHED = 0,
    /**
     * It is not: the commands are those that lead nearest, as far as was found.
     */
    WHIPCORD_REACH_OUTCOME_NEAREST = 1,
    /**
     * Neither reached nor a minimum of the distance found.
     */
    WHIPCORD_REACH_OUTCOME_UNDECIDED = 2,
} whipcord_reach_outcome_t;

/**
 * A robot in motion, with the commands in force.
 */
typedef struct whipcord_simulation_t whipcord_simulation_t;

/**
 * What finds the commands for targets, with the shapes that it starts from.
 */
typedef struct whipcord_reach_t whipcord_reach_t;

/**
 * A robot file.
 */
typedef struct whipcord_robot_t whipcord_robot_t;

/**
 * What a model of a robot is solved with, again and again.
 */
typedef struct whipcord_solver_t whipcord_solver_t;

/**
 * How a solution was obtained.
 */
typedef struct {
    /**
     * Newton iterations.
     */
    size_t iterations;
    /**
     * Integration steps, or sections, from base to tip.
     */
    size_t steps;
    /**
     * What is left of the equations, relative to their scale.
     */
    double residual;
    /**
     * Whether it is stable.
     */
    whipcord_stability_t stability;
} whipcord_diagnostics_t;

/**
 * The answer to an inverse problem.
 */
typedef struct {
    /**
     * What became of the target.
     */
    whipcord_reach_outcome_t outcome;
    /**
     * Distance of the tip from the target in m.
     */
    double position_miss;
    /**
     * Angle from the target in rad; 0 where none is asked for.
     */
    double angle_miss;
    /**
     * Pose of the tip under the commands: x, y, z in m, quaternion w, x, y, z.
     */
    double tip[7];
    /**
     * Solves of the model.
     */
    size_t solves;
} whipcord_reach_result_t;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/**
 * The version of the library, such as "0.1.0".
 */
const char *whipcord_version(void);

/**
 * The version of the binary interface of the library that is loaded; `WHIPCORD_ABI_VERSION` is that of the header.
 */
uint32_t whipcord_abi_version(void);

/**
 * Why the last call that failed in this thread did, in UTF-8; the empty text if none has failed. It is valid until the next call that fails in this thread.
 */
const char *whipcord_last_error(void);

/**
 * Reads a robot file, and the files that it names. `*robot` is then to be freed by `whipcord_robot_free`; after a failure it is NULL.
 *
 * # Safety
 * `path` is a text that ends with a zero, `robot` leads to memory for a pointer; or they are NULL, which is an error.
 */
whipcord_status_t whipcord_robot_load(const char *path,
                                      whipcord_robot_t **robot);

/**
 * Reads the text of a robot file. `name` stands for it in messages, and files that it names are looked for in the folder of `name`; it may be NULL.
 *
 * # Safety
 * As `whipcord_robot_load`.
 */
whipcord_status_t whipcord_robot_parse(const char *content,
                                       const char *name,
                                       whipcord_robot_t **robot);

/**
 * Frees a robot; NULL is ignored. What was made of it stays.
 */
void whipcord_robot_free(whipcord_robot_t *robot);

/**
 * The title of the file in UTF-8, valid as long as the robot; NULL for NULL.
 */
const char *whipcord_robot_title(const whipcord_robot_t *robot);

/**
 * Number of cables; 0 for NULL.
 */
size_t whipcord_robot_cable_count(const whipcord_robot_t *robot);

/**
 * Number of disks; 0 for NULL.
 */
size_t whipcord_robot_disk_count(const whipcord_robot_t *robot);

/**
 * Number of motors; 0 for NULL.
 */
size_t whipcord_robot_motor_count(const whipcord_robot_t *robot);

/**
 * Length of the backbone in m; 0 for NULL.
 */
double whipcord_robot_length(const whipcord_robot_t *robot);

/**
 * The name of a cable in UTF-8, valid as long as the robot; NULL where there is no such cable.
 */
const char *whipcord_robot_cable_name(const whipcord_robot_t *robot, size_t cable);

/**
 * The name of a motor in UTF-8, valid as long as the robot; NULL where there is no such motor.
 */
const char *whipcord_robot_motor_name(const whipcord_robot_t *robot, size_t motor);

/**
 * A solver for a robot by a model, such as "cosserat"; NULL is "cosserat". It starts with the commands and loads of the file. It does not
 * need the robot any more. `*solver` is then to be freed by `whipcord_solver_free`; after a failure it is NULL.
 *
 * # Safety
 * `model` is NULL or a text that ends with a zero, `solver` leads to memory for a pointer or is NULL, which is an error.
 */
whipcord_status_t whipcord_solver_new(const whipcord_robot_t *robot,
                                      const char *model,
                                      whipcord_solver_t **solver);

/**
 * Frees a solver; NULL is ignored.
 */
void whipcord_solver_free(whipcord_solver_t *solver);

/**
 * Goes back to the commands and loads of the file, and forgets the last solution: the next solve is one from cold.
 */
whipcord_status_t whipcord_solver_reset(whipcord_solver_t *solver);

/**
 * What each solve may spend at most: Newton iterations, and integration steps of all shapes that are tried. Work is counted, not time.
 */
whipcord_status_t whipcord_solver_set_budget(whipcord_solver_t *solver,
                                             size_t iterations,
                                             size_t integration_steps);

/**
 * Estimated error of positions and lengths as a part of the length of the backbone, from 1e-13 to 0.01; 1e-6 is what a solver begins with. Models
 * whose sections are their discretisation have none to choose, and ignore it. It allocates memory. The last solution stays.
 */
whipcord_status_t whipcord_solver_set_tolerance(whipcord_solver_t *solver,
                                                double tolerance);

/**
 * Commands every cable by its tension in N. The commands before are kept where this fails.
 *
 * # Safety
 * `tensions` is NULL or leads to `count` numbers.
 */
whipcord_status_t whipcord_solver_set_tensions(whipcord_solver_t *solver,
                                               const double *tensions,
                                               size_t count);

/**
 * Commands every cable by its shortening in m. The commands before are kept where this fails.
 *
 * # Safety
 * `shortenings` is NULL or leads to `count` numbers.
 */
whipcord_status_t whipcord_solver_set_shortenings(whipcord_solver_t *solver,
                                                  const double *shortenings,
                                                  size_t count);

/**
 * Commands each cable in its own way: by its tension in N where its flag is 0, by its shortening in m where it is 1. The commands before are
 * kept where this fails.
 *
 * # Safety
 * `commands` and `by_shortening` are NULL or lead to `count` numbers and `count` bytes.
 */
whipcord_status_t whipcord_solver_set_commands(whipcord_solver_t *solver,
                                               const double *commands,
                                               const uint8_t *by_shortening,
                                               size_t count);

/**
 * Commands every motor: its angle in rad, or its travel in m. Cables without a motor keep their commands. The commands before are kept where this fails.
 *
 * # Safety
 * `commands` is NULL or leads to `count` numbers.
 */
whipcord_status_t whipcord_solver_set_motors(whipcord_solver_t *solver,
                                             const double *commands,
                                             size_t count);

/**
 * Sets force in N and moment in N·m at the tip, in the frame that the file gives its loads in; NULL is none. All other loads stay.
 *
 * # Safety
 * `force` and `moment` are NULL or lead to 3 numbers each.
 */
whipcord_status_t whipcord_solver_set_tip_load(whipcord_solver_t *solver,
                                               const double *force,
                                               const double *moment);

/**
 * Solves for the commands and loads at hand. The first solve starts from the robot without load, and goes through the steps of the file;
 * each other one starts from the solution before, and without obstacles and friction allocates nothing once the solver has its memory, but by "four-bar". After a failure the solution
 * before is kept, and so are the new commands. `WHIPCORD_STATUS_BUDGET_SPENT` comes with a solution, the best shape so far.
 */
whipcord_status_t whipcord_solver_solve(whipcord_solver_t *solver);

/**
 * The pose of the tip in the world: x, y, z in m, quaternion w, x, y, z.
 *
 * # Safety
 * `pose` is NULL or leads to memory for 7 numbers.
 */
whipcord_status_t whipcord_solver_tip_pose(const whipcord_solver_t *solver, double *pose);

/**
 * The poses of all disks from the base on, 7 numbers each as in `whipcord_solver_tip_pose`.
 *
 * # Safety
 * `poses` is NULL or leads to memory for `count` numbers.
 */
whipcord_status_t whipcord_solver_disk_poses(const whipcord_solver_t *solver, double *poses, size_t count);

/**
 * The tension of each cable in N. `WHIPCORD_STATUS_UNAVAILABLE` by a model that computes none.
 *
 * # Safety
 * `tensions` is NULL or leads to memory for `count` numbers.
 */
whipcord_status_t whipcord_solver_tensions(const whipcord_solver_t *solver, double *tensions, size_t count);

/**
 * The length in m of each cable inside the robot.
 *
 * # Safety
 * `lengths` is NULL or leads to memory for `count` numbers.
 */
whipcord_status_t whipcord_solver_lengths(const whipcord_solver_t *solver, double *lengths, size_t count);

/**
 * For each cable 1 where it is slack, else 0.
 *
 * # Safety
 * `slack` is NULL or leads to memory for `count` bytes.
 */
whipcord_status_t whipcord_solver_slack(const whipcord_solver_t *solver, uint8_t *slack, size_t count);

/**
 * How the solution was obtained.
 *
 * # Safety
 * `diagnostics` is NULL or leads to memory for the structure.
 */
whipcord_status_t whipcord_solver_diagnostics(const whipcord_solver_t *solver,
                                              whipcord_diagnostics_t *diagnostics);

/**
 * The Jacobian of the tip at the last solution, before commands are set anew: 6 rows of one column for each cable, row by row. The rows are the
 * velocity of the tip's point in m and its angular velocity in rad, in the world, for each N or m of the command of the
 * cable. Without obstacles and friction it allocates nothing once the solver has its memory, but by "four-bar".
 *
 * # Safety
 * `jacobian` is NULL or leads to memory for `count` numbers.
 */
whipcord_status_t whipcord_solver_tip_jacobian(whipcord_solver_t *solver,
                                               double *jacobian,
                                               size_t count);

/**
 * What finds the commands for targets, by a model; NULL is "cosserat". Limits, tolerances and preference are those of the file; the commands are
 * those that the file gives: the motors where there are some, else tensions or shortenings. `*reach` is then to be freed by `whipcord_reach_free`;
 * after a failure it is NULL.
 *
 * # Safety
 * `model` is NULL or a text that ends with a zero, `reach` leads to memory for a pointer or is NULL, which is an error.
 */
whipcord_status_t whipcord_reach_new(const whipcord_robot_t *robot,
                                     const char *model,
                                     whipcord_reach_t **reach);

/**
 * Frees it; NULL is ignored.
 */
void whipcord_reach_free(whipcord_reach_t *reach);

/**
 * Number of commands; 0 for NULL.
 */
size_t whipcord_reach_command_count(const whipcord_reach_t *reach);

/**
 * What a command is, and the number of its cable or motor from 0.
 *
 * # Safety
 * `kind` and `number` are NULL, which is an error, or lead to memory for one value each.
 */
whipcord_status_t whipcord_reach_command(const whipcord_reach_t *reach,
                                         size_t command,
                                         whipcord_command_kind_t *kind,
                                         size_t *number);

/**
 * Finds the commands that bring the tip to a point in the world, in m. A target that is not reached is no failure: the result says it.
 *
 * # Safety
 * `point` is NULL or leads to 3 numbers, `result` is NULL or leads to memory for the structure.
 */
whipcord_status_t whipcord_reach_tip(whipcord_reach_t *reach,
                                     const double *point,
                                     whipcord_reach_result_t *result);

/**
 * The same for a pose of the tip: x, y, z in m, quaternion w, x, y, z.
 *
 * # Safety
 * `pose` is NULL or leads to 7 numbers, `result` is NULL or leads to memory for the structure.
 */
whipcord_status_t whipcord_reach_pose(whipcord_reach_t *reach,
                                      const double *pose,
                                      whipcord_reach_result_t *result);

/**
 * The same for the target of the file.
 *
 * # Safety
 * `result` is NULL or leads to memory for the structure.
 */
whipcord_status_t whipcord_reach_target(whipcord_reach_t *reach, whipcord_reach_result_t *result);

/**
 * The commands of the last answer, in N, m or rad.
 *
 * # Safety
 * `commands` is NULL or leads to memory for `count` numbers.
 */
whipcord_status_t whipcord_reach_commands(const whipcord_reach_t *reach, double *commands, size_t count);

/**
 * The motion of a robot from the commands and loads of its file, with the options of `[motion]`. `*simulation` is then to be freed by
 * `whipcord_simulation_free`; after a failure it is NULL.
 *
 * # Safety
 * `simulation` leads to memory for a pointer or is NULL, which is an error.
 */
whipcord_status_t whipcord_simulation_new(const whipcord_robot_t *robot,
                                          whipcord_simulation_t **simulation);

/**
 * Frees a simulation; NULL is ignored.
 */
void whipcord_simulation_free(whipcord_simulation_t *simulation);

/**
 * Commands every cable by its tension in N from now on. The commands before are kept where this fails.
 *
 * # Safety
 * `tensions` is NULL or leads to `count` numbers.
 */
whipcord_status_t whipcord_simulation_set_tensions(whipcord_simulation_t *simulation,
                                                   const double *tensions,
                                                   size_t count);

/**
 * Commands every cable by its shortening in m from now on. The commands before are kept where this fails.
 *
 * # Safety
 * `shortenings` is NULL or leads to `count` numbers.
 */
whipcord_status_t whipcord_simulation_set_shortenings(whipcord_simulation_t *simulation,
                                                      const double *shortenings,
                                                      size_t count);

/**
 * Commands each cable in its own way from now on: by its tension in N where its flag is 0, by its shortening in m where it is 1. The commands
 * before are kept where this fails.
 *
 * # Safety
 * `commands` and `by_shortening` are NULL or lead to `count` numbers and `count` bytes.
 */
whipcord_status_t whipcord_simulation_set_commands(whipcord_simulation_t *simulation,
                                                   const double *commands,
                                                   const uint8_t *by_shortening,
                                                   size_t count);

/**
 * Commands every motor from now on: its angle in rad, or its travel in m. The commands before are kept where this fails.
 *
 * # Safety
 * `commands` is NULL or leads to `count` numbers.
 */
whipcord_status_t whipcord_simulation_set_motors(whipcord_simulation_t *simulation,
                                                 const double *commands,
                                                 size_t count);

/**
 * Takes a step of `dt` seconds. After the first steps it allocates nothing. After a failure the state is that before the step.
 */
whipcord_status_t whipcord_simulation_step(whipcord_simulation_t *simulation,
                                           double dt);

/**
 * Time in s since the start; 0 for NULL.
 */
double whipcord_simulation_time(const whipcord_simulation_t *simulation);

/**
 * Number of nodes along the backbone; 0 for NULL.
 */
size_t whipcord_simulation_node_count(const whipcord_simulation_t *simulation);

/**
 * The pose of the tip in the world: x, y, z in m, quaternion w, x, y, z.
 *
 * # Safety
 * `pose` is NULL or leads to memory for 7 numbers.
 */
whipcord_status_t whipcord_simulation_tip_pose(const whipcord_simulation_t *simulation, double *pose);

/**
 * The poses of all nodes from the base on, 7 numbers each.
 *
 * # Safety
 * `poses` is NULL or leads to memory for `count` numbers.
 */
whipcord_status_t whipcord_simulation_node_poses(const whipcord_simulation_t *simulation,
                                                 double *poses,
                                                 size_t count);

/**
 * The tension of each cable in N.
 *
 * # Safety
 * `tensions` is NULL or leads to memory for `count` numbers.
 */
whipcord_status_t whipcord_simulation_tensions(const whipcord_simulation_t *simulation,
                                               double *tensions,
                                               size_t count);

/**
 * The length in m of each cable inside the robot.
 *
 * # Safety
 * `lengths` is NULL or leads to memory for `count` numbers.
 */
whipcord_status_t whipcord_simulation_lengths(const whipcord_simulation_t *simulation,
                                              double *lengths,
                                              size_t count);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* WHIPCORD_H */
