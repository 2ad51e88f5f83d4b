/*
 * Solves the case of a robot file and prints the pose of the tip and the tensions with all digits.
 *
 *     solve ROBOT-FILE [MODEL]
 */
#include <stdio.h>
#include <stdlib.h>

#include <whipcord.h>

static int failed(whipcord_status_t status)
{
    if (status == WHIPCORD_STATUS_OK) {
        return 0;
    }
    fprintf(stderr, "%s\n", whipcord_last_error());
    return 1;
}

int main(int argc, char **argv)
{
    if (argc < 2) {
        fprintf(stderr, "usage: %s ROBOT-FILE [MODEL]\n", argv[0]);
        return 2;
    }
    if (whipcord_abi_version() != WHIPCORD_ABI_VERSION) {
        fprintf(stderr, "the library is not the one of the header\n");
        return 1;
    }
    whipcord_robot_t *robot = NULL;
    whipcord_solver_t *solver = NULL;
    double *tensions = NULL;
    double tip[7];
    int status = 1;

    if (failed(whipcord_robot_load(argv[1], &robot))) {
        goto end;
    }
    if (failed(whipcord_solver_new(robot, argc > 2 ? argv[2] : NULL, &solver))) {
        goto end;
    }
    if (failed(whipcord_solver_solve(solver)) || failed(whipcord_solver_tip_pose(solver, tip))) {
        goto end;
    }
    printf("tip");
    for (int i = 0; i < 7; ++i) {
        printf(" %.17g", tip[i]);
    }
    printf("\n");
    const size_t cables = whipcord_robot_cable_count(robot);
    tensions = calloc(cables + 1, sizeof *tensions);
    if (tensions == NULL || failed(whipcord_solver_tensions(solver, tensions, cables))) {
        goto end;
    }
    for (size_t i = 0; i < cables; ++i) {
        printf("%s %.17g\n", whipcord_robot_cable_name(robot, i), tensions[i]);
    }
    status = 0;

end:
    free(tensions);
    whipcord_solver_free(solver);
    whipcord_robot_free(robot);
    return status;
}
