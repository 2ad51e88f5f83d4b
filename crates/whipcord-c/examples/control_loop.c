/*
 * A controller at 1 kHz: in each cycle it solves for the tensions of the cables, from the solution of the cycle before, reads the pose of the
 * tip and its Jacobian, and corrects the tensions so that the tip follows a circle. Prints the times of the cycles and the greatest distance
 * from the circle.
 *
 *     control_loop ROBOT-FILE [CYCLES]
 */
#define _POSIX_C_SOURCE 200809L

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#include <whipcord.h>

#define PERIOD_NS 1000000L
#define MOST_CABLES 16

static void check(whipcord_status_t status)
{
    if (status != WHIPCORD_STATUS_OK) {
        fprintf(stderr, "%s\n", whipcord_last_error());
        exit(1);
    }
}

static double seconds_since(const struct timespec *begun)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)(now.tv_sec - begun->tv_sec) + 1e-9 * (double)(now.tv_nsec - begun->tv_nsec);
}

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Changes tensions so that the tip moves by `move` in x and y: the least change that does so, by the first two rows of the Jacobian. */
static void correct(double *tensions, size_t cables, const double *jacobian, const double move[2])
{
    const double *x = jacobian, *y = jacobian + cables;
    double xx = 0.0, xy = 0.0, yy = 0.0;
    for (size_t i = 0; i < cables; ++i) {
        xx += x[i] * x[i];
        xy += x[i] * y[i];
        yy += y[i] * y[i];
    }
    const double determinant = xx * yy - xy * xy;
    if (!(determinant > 1e-9 * (xx * yy))) {
        return; /* All cables pull the tip in one direction. */
    }
    const double a = (yy * move[0] - xy * move[1]) / determinant;
    const double b = (xx * move[1] - xy * move[0]) / determinant;
    for (size_t i = 0; i < cables; ++i) {
        tensions[i] = fmax(0.0, tensions[i] + a * x[i] + b * y[i]);
    }
}

int main(int argc, char **argv)
{
    if (argc < 2) {
        fprintf(stderr, "usage: %s ROBOT-FILE [CYCLES]\n", argv[0]);
        return 2;
    }
    const long cycles = argc > 2 ? strtol(argv[2], NULL, 10) : 2000;
    if (cycles < 1 || cycles > 1000000) {
        fprintf(stderr, "give 1 to 1000000 cycles\n");
        return 2;
    }

    whipcord_robot_t *robot = NULL;
    whipcord_solver_t *solver = NULL;
    check(whipcord_robot_load(argv[1], &robot));
    const size_t cables = whipcord_robot_cable_count(robot);
    if (cables < 2 || cables > MOST_CABLES) {
        fprintf(stderr, "the robot has %zu cables: this example is for 2 to %d\n", cables, MOST_CABLES);
        whipcord_robot_free(robot);
        return 1;
    }
    check(whipcord_solver_new(robot, "cosserat", &solver));
    whipcord_robot_free(robot);

    double tensions[MOST_CABLES], jacobian[6 * MOST_CABLES], pose[7], centre[7];
    check(whipcord_solver_solve(solver));
    check(whipcord_solver_tensions(solver, tensions, cables));
    check(whipcord_solver_tip_pose(solver, centre));

    double *times = malloc((size_t)cycles * sizeof *times);
    if (times == NULL) {
        fprintf(stderr, "no memory\n");
        whipcord_solver_free(solver);
        return 1;
    }
    const double radius = 2e-3, angular_rate = 6.283185307179586;
    double farthest = 0.0;
    struct timespec next;
    clock_gettime(CLOCK_MONOTONIC, &next);
    for (long cycle = 0; cycle < cycles; ++cycle) {
        struct timespec begun;
        clock_gettime(CLOCK_MONOTONIC, &begun);
        check(whipcord_solver_set_tensions(solver, tensions, cables));
        check(whipcord_solver_solve(solver));
        check(whipcord_solver_tip_pose(solver, pose));
        check(whipcord_solver_tip_jacobian(solver, jacobian, 6 * cables));
        const double angle = angular_rate * 1e-3 * (double)cycle;
        const double move[2] = {
            centre[0] + radius * (cos(angle) - 1.0) - pose[0],
            centre[1] + radius * sin(angle) - pose[1],
        };
        correct(tensions, cables, jacobian, move);
        times[cycle] = seconds_since(&begun);
        farthest = fmax(farthest, hypot(move[0], move[1]));

        next.tv_nsec += PERIOD_NS;
        if (next.tv_nsec >= 1000000000L) {
            next.tv_nsec -= 1000000000L;
            next.tv_sec += 1;
        }
        clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, NULL);
    }
    qsort(times, (size_t)cycles, sizeof *times, ascending);
    printf("cycles %ld\n", cycles);
    printf("median %.1f us, worst %.1f us\n", 1e6 * times[cycles / 2], 1e6 * times[cycles - 1]);
    printf("greatest distance from the circle %.4f mm\n", 1e3 * farthest);
    free(times);
    whipcord_solver_free(solver);
    return farthest < 0.1 * radius ? 0 : 1;
}
