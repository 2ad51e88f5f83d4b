/*
 * A MEX function for GNU Octave and MATLAB: the pose of the tip of a robot.
 *
 *     tip = whipcord_tip(file)             under the commands of the file
 *     tip = whipcord_tip(file, tensions)   under these tensions in N, one for each cable
 *
 * tip is a row of x, y, z in m and the quaternion w, x, y, z. Built by
 *
 *     mkoctfile --mex whipcord_tip.c $(pkg-config --cflags --libs whipcord)
 */
#include <string.h>

#include <mex.h>
#include <whipcord.h>

/* Leaves the function with the message of the library; handles are freed before, since mexErrMsgIdAndTxt does not return. */
static void check(whipcord_status_t status, whipcord_robot_t *robot, whipcord_solver_t *solver)
{
    char message[2000];
    if (status == WHIPCORD_STATUS_OK) {
        return;
    }
    strncpy(message, whipcord_last_error(), sizeof message - 1);
    message[sizeof message - 1] = '\0';
    whipcord_solver_free(solver);
    whipcord_robot_free(robot);
    mexErrMsgIdAndTxt("whipcord:failed", "%s", message);
}

void mexFunction(int nlhs, mxArray *plhs[], int nrhs, const mxArray *prhs[])
{
    (void)nlhs;
    if (nrhs < 1 || nrhs > 2 || !mxIsChar(prhs[0])) {
        mexErrMsgIdAndTxt("whipcord:usage", "call tip = whipcord_tip(file) or whipcord_tip(file, tensions)");
    }
    if (nrhs == 2 && (!mxIsDouble(prhs[1]) || mxIsComplex(prhs[1]))) {
        mexErrMsgIdAndTxt("whipcord:usage", "the tensions must be real numbers");
    }
    whipcord_robot_t *robot = NULL;
    whipcord_solver_t *solver = NULL;
    char *file = mxArrayToString(prhs[0]);
    const whipcord_status_t loaded = whipcord_robot_load(file, &robot);
    mxFree(file);
    check(loaded, robot, solver);
    check(whipcord_solver_new(robot, "cosserat", &solver), robot, solver);
    if (nrhs == 2) {
        const size_t count = mxGetNumberOfElements(prhs[1]);
        check(whipcord_solver_set_tensions(solver, mxGetPr(prhs[1]), count), robot, solver);
    }
    check(whipcord_solver_solve(solver), robot, solver);
    plhs[0] = mxCreateDoubleMatrix(1, 7, mxREAL);
    check(whipcord_solver_tip_pose(solver, mxGetPr(plhs[0])), robot, solver);
    whipcord_solver_free(solver);
    whipcord_robot_free(robot);
}
