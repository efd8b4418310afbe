/* The hemodynamic model for solvers in C and Fortran, driven by hemodynamics.py: the equations in conductances, states scaled as
 * y = [d_C1/D d_C2/D d_V/D, their rates in 1/s], analytic Jacobian, a restart where the load breaks.
 *
 * A response is an interval under a load, then one without; each runs in its own time from 0, so no solver loses digits to a late start.
 * CVODE is linked (unless built with -DNO_CVODE); RADAU5 and DLSODA are handed in as pointers, from the library that has them.
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define STATES 6

static struct {
    double push[3], spring[3], damper[3], swept[3], conductance[3], venule[2], upstream, downstream;
    double outside[3];
    long evaluations;
} model;

/* 23 numbers: push, spring, damper, swept, conductance of C1 C2 V, both venules, P_H, P_L; made once, in Python. */
void parameters(const double *p) {
    memcpy(model.push, p, 3 * sizeof *p);
    memcpy(model.spring, p + 3, 3 * sizeof *p);
    memcpy(model.damper, p + 6, 3 * sizeof *p);
    memcpy(model.swept, p + 9, 3 * sizeof *p);
    memcpy(model.conductance, p + 12, 3 * sizeof *p);
    memcpy(model.venule, p + 15, 2 * sizeof *p);
    model.upstream = p[17];
    model.downstream = p[18];
}

static void load(double pf1, double pf2) {
    model.outside[0] = 0;
    model.outside[1] = pf2;
    model.outside[2] = pf1;
}

long evaluations(void) { return model.evaluations; }

static void right(const double *y, double *f) {
    const double *w = y + 3;
    double g[3], t[2], blood[3], venous, total;
    model.evaluations++;
    for (int j = 0; j < 3; j++) {
        double square = y[j] * y[j];
        g[j] = model.conductance[j] * (square * square);
    }
    total = g[2];
    venous = g[2] * model.downstream - model.swept[2] * w[2];
    for (int i = 0; i < 2; i++) {
        t[i] = 1 / (1 + g[i] * model.venule[i]);
        blood[i] = (g[i] * model.upstream - model.swept[i] * w[i]) * t[i];
        venous += blood[i];
        total += g[i] * t[i];
    }
    blood[2] = venous /= total;
    for (int i = 0; i < 2; i++) blood[i] = model.venule[i] * blood[i] + venous * t[i];
    for (int j = 0; j < 3; j++) {
        f[j] = w[j];
        f[3 + j] = model.push[j] * (blood[j] - model.outside[j]) - model.spring[j] * (y[j] - 1) - model.damper[j] * w[j];
    }
}

/* Column by column. */
static void jacobian(const double *y, double *pd) {
    const double *w = y + 3;
    double g[3], t[2], slope[3], drop[3], by_lumen[3], by_rate[3], venous, total;
    for (int j = 0; j < 3; j++) {
        double square = y[j] * y[j];
        g[j] = model.conductance[j] * (square * square);
        slope[j] = 4 * model.conductance[j] * square * y[j];
    }
    total = g[2];
    venous = g[2] * model.downstream - model.swept[2] * w[2];
    for (int i = 0; i < 2; i++) {
        t[i] = 1 / (1 + g[i] * model.venule[i]);
        venous += (g[i] * model.upstream - model.swept[i] * w[i]) * t[i];
        total += g[i] * t[i];
    }
    venous /= total;
    for (int i = 0; i < 2; i++) {
        drop[i] = (model.upstream - venous + model.venule[i] * model.swept[i] * w[i]) * t[i];
        by_lumen[i] = slope[i] * drop[i] * t[i] / total;
        by_rate[i] = -model.swept[i] * t[i] / total;
    }
    by_lumen[2] = -slope[2] * (venous - model.downstream) / total;
    by_rate[2] = -model.swept[2] / total;
    memset(pd, 0, STATES * STATES * sizeof *pd);
    for (int j = 0; j < 3; j++) {
        pd[STATES * (3 + j) + j] = 1;
        for (int i = 0; i < 3; i++) {
            double border = model.push[i] * (i < 2 ? t[i] : 1);
            pd[STATES * j + 3 + i] = border * by_lumen[j];
            pd[STATES * (3 + j) + 3 + i] = border * by_rate[j];
        }
        pd[STATES * j + 3 + j] -= model.spring[j];
        pd[STATES * (3 + j) + 3 + j] -= model.damper[j];
        if (j < 2) {
            pd[STATES * j + 3 + j] += model.push[j] * model.venule[j] * slope[j] * drop[j] * t[j];
            pd[STATES * (3 + j) + 3 + j] -= model.push[j] * model.venule[j] * model.swept[j] * t[j];
        }
    }
}

/* For tests of the above from outside. */
void at(const double *y, double pf1, double pf2, double *f, double *pd) {
    load(pf1, pf2);
    right(y, f);
    jacobian(y, pd);
}

/* Outputs at `times` (rising, after 0, at most `end`) of one interval, from y, which ends up at `end`: 0 when all went well. */
typedef int interval(double *y, double end, int count, const double *times, double *out, double rtol, const double *atol);

/* ---- DLSODA ---- */
typedef void of_fortran(int *, double *, double *, double *, double *, int *);
typedef void jacobian_of_fortran(int *, double *, double *, int *, int *, double *, int *, double *, int *);
typedef void lsoda(of_fortran *, int *, double *, double *, double *, int *, double *, double *, int *, int *, int *, double *, int *, int *,
                   int *, jacobian_of_fortran *, int *, double *, int *);
static lsoda *dlsoda;

static void f_right(int *n, double *t, double *y, double *f, double *rpar, int *ipar) { right(y, f); }
static void f_jacobian(int *n, double *t, double *y, int *ml, int *mu, double *pd, int *rows, double *rpar, int *ipar) { jacobian(y, pd); }

static int by_lsoda(double *y, double end, int count, const double *times, double *out, double rtol, const double *atol) {
    double rwork[22 + STATES * 16 + STATES * STATES] = {0}, tolerances[STATES], t = 0;
    int n = STATES, itol = 2, itask = 4, istate = 1, iopt = 1, iwork[20 + STATES] = {0}, lrw = sizeof rwork / sizeof *rwork, liw = 20 + STATES, jt = 1, ipar = 0;
    double rpar = 0, last = count && times[count - 1] == end;
    memcpy(tolerances, atol, sizeof tolerances);
    rwork[0] = end;
    iwork[5] = 1000000;
    iwork[7] = 12;
    iwork[8] = 5;
    for (int k = 0; k < count + !last; k++) {
        double next = k < count ? times[k] : end;
        dlsoda(f_right, &n, y, &t, &next, &itol, &rtol, tolerances, &itask, &istate, &iopt, rwork, &lrw, iwork, &liw, f_jacobian, &jt, &rpar, &ipar);
        if (istate < 0) return istate;
        if (k < count) memcpy(out + STATES * k, y, STATES * sizeof *y);
    }
    return 0;
}

/* ---- RADAU5 ---- */
typedef void seen(int *, double *, double *, double *, double *, int *, int *, double *, int *, int *, double *);
typedef void radau(int *, of_fortran *, double *, double *, double *, double *, double *, double *, int *, jacobian_of_fortran *, int *, int *,
                   int *, void *, int *, int *, int *, seen *, int *, double *, int *, int *, int *, double *, int *, int *);
typedef void between(int *, double *, double *, int *, double *);
static radau *radau5;
static between *contr5;
static struct {
    int next, count;
    const double *times;
    double *out;
} wanted;

static void f_seen(int *nr, double *before, double *t, double *y, double *con, int *lrc, int *n, double *rpar, int *ipar, int *stop, double *xout) {
    *stop = 0;
    while (wanted.next < wanted.count && wanted.times[wanted.next] <= *t) {
        double at = wanted.times[wanted.next];
        if (at == *t)
            memcpy(wanted.out + STATES * wanted.next, y, STATES * sizeof *y);
        else
            contr5(n, &at, con, lrc, wanted.out + STATES * wanted.next);
        wanted.next++;
    }
}

static int by_radau(double *y, double end, int count, const double *times, double *out, double rtol, const double *atol) {
    double work[4 * STATES * STATES + 12 * STATES + 20] = {0}, relative[STATES], absolute[STATES], t = 0, h = 1e-6, rpar = 0;
    int n = STATES, itol = 1, ijac = 1, full = STATES, imas = 0, iout = 2, lwork = sizeof work / sizeof *work, iwork[3 * STATES + 20] = {0}, liwork = 3 * STATES + 20;
    int ipar = 0, idid = 0;
    for (int j = 0; j < STATES; j++) relative[j] = rtol;
    memcpy(absolute, atol, sizeof absolute);
    wanted.next = 0;
    wanted.count = count;
    wanted.times = times;
    wanted.out = out;
    iwork[1] = 1000000;
    radau5(&n, f_right, &t, y, &end, &h, relative, absolute, &itol, f_jacobian, &ijac, &full, &full, NULL, &imas, &full, &full, f_seen, &iout, work,
           &lwork, iwork, &liwork, &rpar, &ipar, &idid);
    return idid == 1 && wanted.next == count ? 0 : -1;
}

void solvers(void *a, void *b, void *c) {
    dlsoda = (lsoda *)a;
    radau5 = (radau *)b;
    contr5 = (between *)c;
}

/* ---- CVODE ---- */
#ifndef NO_CVODE
#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sundials/sundials_config.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

static int c_right(double t, N_Vector y, N_Vector f, void *data) {
    right(N_VGetArrayPointer(y), N_VGetArrayPointer(f));
    return 0;
}

static int c_jacobian(double t, N_Vector y, N_Vector f, SUNMatrix j, void *data, N_Vector a, N_Vector b, N_Vector c) {
    jacobian(N_VGetArrayPointer(y), SUNDenseMatrix_Data(j));
    return 0;
}

static int by_cvode(double *y, double end, int count, const double *times, double *out, double rtol, const double *atol) {
    static SUNContext context;
    static N_Vector state, absolute;
    static void *memory;
    int fault;
    double t = 0;
    if (!memory) {
#if SUNDIALS_VERSION_MAJOR >= 7
        SUNContext_Create(SUN_COMM_NULL, &context);
#else
        SUNContext_Create(NULL, &context);
#endif
        state = N_VNew_Serial(STATES, context);
        absolute = N_VNew_Serial(STATES, context);
        memory = CVodeCreate(CV_BDF, context);
        if (CVodeInit(memory, c_right, 0, state)) return -1;
        SUNMatrix matrix = SUNDenseMatrix(STATES, STATES, context);
        if (CVodeSStolerances(memory, 1e-3, 1e-3)) return -1;
        if (CVodeSetLinearSolver(memory, SUNLinSol_Dense(state, matrix, context), matrix)) return -1;
        if (CVodeSetJacFn(memory, c_jacobian) || CVodeSetMaxNumSteps(memory, 1000000)) return -1;
    }
    memcpy(N_VGetArrayPointer(state), y, STATES * sizeof *y);
    memcpy(N_VGetArrayPointer(absolute), atol, STATES * sizeof *atol);
    if (CVodeReInit(memory, 0, state) || CVodeSVtolerances(memory, rtol, absolute) || CVodeSetStopTime(memory, end)) return -1;
    for (int k = 0; k < count; k++) {
        fault = CVode(memory, times[k], state, &t, CV_NORMAL);
        if (fault < 0) return fault;
        memcpy(out + STATES * k, N_VGetArrayPointer(state), STATES * sizeof *out);
    }
    if (!count || times[count - 1] != end) {
        fault = CVode(memory, end, state, &t, CV_NORMAL);
        if (fault < 0) return fault;
    }
    memcpy(y, N_VGetArrayPointer(state), STATES * sizeof *y);
    return 0;
}
#endif

/* Responses to steps of load: `count` outputs in the first interval, `later` in the second, 6 values each. 0 when all went well. */
int responses(int solver, int cases, const double *pf1, const double *pf2, const double *rest, double interval_s, double rtol,
              const double *atol, int count, const double *times, int later, const double *later_times, double *out) {
    interval *by = solver == 0 ? by_lsoda : solver == 1 ? by_radau :
#ifndef NO_CVODE
                                                        by_cvode;
#else
                                                        NULL;
#endif
    int fault = 0;
    model.evaluations = 0;
    for (int k = 0; k < cases && !fault; k++) {
        double y[STATES];
        memcpy(y, rest, sizeof y);
        load(pf1[k], pf2[k]);
        fault = by(y, interval_s, count, times, out, rtol, atol);
        out += STATES * count;
        load(0, 0);
        if (!fault) fault = by(y, interval_s, later, later_times, out, rtol, atol);
        out += STATES * later;
    }
    return fault;
}
