/* SUNDIALS' CVODE on the rigid links with one clearance joint, called from C.
 *
 * The equations are those of study/mechanism/rigid.py, with Hertz's law; so is their derivative,
 * which CVODE gets. Contact is either in coordinates of its own, (depth, direction), or, as flight,
 * in (e_x, e_y). Each meeting and parting of the surfaces is a root, at which CVODE starts anew.
 */

#include <cvode/cvode.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

typedef struct { /* as study.mechanism.scene.Constants */
    double l1, l2, a11, a22, a12, m2, m3, moment, g1, g2, r1, clearance, damping;
    double friction, v0, v1, steady, gravity;
} Constants;

typedef struct {
    const Constants *p;
    double scale, approach; /* Hertz's law: N at a depth of one clearance; approach speed */
    int contact, polar;     /* do the surfaces touch, and has contact its own coordinates */
    int evaluations;        /* calls of `motion` by CVODE */
    double force, growth;   /* normal force at the last call of `motion`, and its rate */
} Piece;

/* Accelerations z'' at y = (z, z'), the slider's last; their derivatives to y unless jac is NULL. */
static void motion(Piece *s, const double *y, double *f, double jac[3][6])
{
    const Constants *p = s->p;
    const int polar = s->contact && s->polar;
    const double l1 = p->l1, l2 = p->l2, st = sin(y[0]), ct = cos(y[0]), omega = y[3];
    double nx = 1, ny = 0, r, ey, wx, wy, rate, across;
    if (polar) {
        nx = cos(y[2]), ny = sin(y[2]);
        r = p->clearance + y[1], ey = r * ny;
        rate = y[4], across = r * y[5];
        wx = rate * nx - across * ny, wy = rate * ny + across * nx;
    } else {
        ey = y[2], wx = y[4], wy = y[5];
        r = sqrt(y[1] * y[1] + ey * ey);
        if (r > 0) nx = y[1] / r, ny = ey / r;
        rate = wx * nx + wy * ny, across = wy * nx - wx * ny;
    }
    const double depth = polar ? y[1] : r - p->clearance;
    const double sp = (ey - l1 * st) / l2, cp = sqrt(1 - sp * sp);
    const double psi = (wy - l1 * ct * omega) / (l2 * cp);
    const double sliding = across + p->r1 * psi;

    double normal = 0, normal_d = 0, normal_r = 0, tangential = 0, drag = 0, steep = 0;
    if (s->contact && depth > 0) {
        const double share = depth / p->clearance, root = sqrt(share);
        const double elastic = s->scale * share * root, loss = p->damping / s->approach;
        normal = elastic * (1 + loss * rate);
        normal_d = 1.5 * s->scale / p->clearance * root * (1 + loss * rate);
        normal_r = elastic * loss;
        const double speed = fabs(sliding);
        if (normal > 0 && speed > p->v0) {
            const int full = speed >= p->v1;
            const double factor = full ? 1 : (speed - p->v0) / (p->v1 - p->v0);
            drag = -p->friction * copysign(factor, sliding);
            tangential = drag * normal;
            steep = full ? 0 : -p->friction * normal / (p->v1 - p->v0);
        }
    }
    const double fx = -normal * nx - tangential * ny, fy = -normal * ny + tangential * nx;

    const double cross = p->a12 * (st * cp - ct * sp), coupling = p->a12 * (ct * cp + st * sp);
    const double q1 = p->moment - cross * psi * psi + l1 * (ct * fy - st * fx) - p->g1 * ct;
    const double q2 = cross * omega * omega + l2 * (cp * fy - sp * fx) + p->r1 * tangential
                      - p->g2 * cp;
    const double whole = 1 / (p->a11 * p->a22 - coupling * coupling);
    const double alpha = (p->a22 * q1 - coupling * q2) * whole;
    const double beta = (p->a11 * q2 - coupling * q1) * whole;
    const double slider = -fx / p->m3;
    const double ax = -l1 * (st * alpha + ct * omega * omega)
                      - l2 * (sp * beta + cp * psi * psi) - slider;
    const double ay = l1 * (ct * alpha - st * omega * omega) + l2 * (cp * beta - sp * psi * psi);
    const double spin = polar ? y[5] : 0;
    f[0] = alpha, f[1] = ax, f[2] = ay, f[3] = slider;
    const double turning = r > 0 ? across * across / r : 0;
    s->force = normal, s->growth = normal_d * rate + normal_r * (nx * ax + ny * ay + turning);
    if (polar) {
        f[1] = nx * ax + ny * ay + r * spin * spin;
        f[2] = (nx * ay - ny * ax - 2 * rate * spin) / r;
    }
    if (!jac) return;
    for (int j = 0; j < 6; j++) { /* derivatives along each of y */
        const double dt = j == 0, u1 = j == 1, u2 = j == 2, dw = j == 3, u4 = j == 4, u5 = j == 5;
        double dr, db, drate, dacross, dey, dwy;
        if (polar) {
            dr = u1, db = u2, drate = u4, dacross = u1 * spin + r * u5;
            dey = dr * ny + r * nx * db;
            dwy = drate * ny + dacross * nx + wx * db;
        } else {
            dr = nx * u1 + ny * u2, db = r > 0 ? (nx * u2 - ny * u1) / r : 0;
            drate = nx * u4 + ny * u5 + across * db, dacross = nx * u5 - ny * u4 - rate * db;
            dey = u2, dwy = u5;
        }
        const double dp = (dey - l1 * ct * dt) / (l2 * cp);
        const double dpsi = (dwy + l1 * (st * omega * dt - ct * dw)) / (l2 * cp)
                            + psi * sp / cp * dp;
        const double dnormal = normal_d * dr + normal_r * drate;
        const double dtangential = drag * dnormal + steep * (dacross + p->r1 * dpsi);
        const double dfx = -dnormal * nx - dtangential * ny
                           + (normal * ny - tangential * nx) * db;
        const double dfy = -dnormal * ny + dtangential * nx
                           - (normal * nx + tangential * ny) * db;
        const double dcross = coupling * (dt - dp), dcoupling = -cross * (dt - dp);
        const double dq1 = -dcross * psi * psi - 2 * cross * psi * dpsi - dcoupling * beta
                           + l1 * (ct * dfy - st * dfx - (st * fy + ct * fx) * dt)
                           + p->g1 * st * dt;
        const double dq2 = dcross * omega * omega + 2 * cross * omega * dw - dcoupling * alpha
                           + l2 * (cp * dfy - sp * dfx - (sp * fy + cp * fx) * dp)
                           + p->r1 * dtangential + p->g2 * sp * dp;
        const double dalpha = (p->a22 * dq1 - coupling * dq2) * whole;
        const double dbeta = (p->a11 * dq2 - coupling * dq1) * whole;
        const double dax = dfx / p->m3
            - l1 * (st * dalpha + ct * (alpha * dt + 2 * omega * dw) - st * omega * omega * dt)
            - l2 * (sp * dbeta + cp * (beta * dp + 2 * psi * dpsi) - sp * psi * psi * dp);
        const double day =
            l1 * (ct * dalpha - st * (alpha * dt + 2 * omega * dw) - ct * omega * omega * dt)
            + l2 * (cp * dbeta - sp * (beta * dp + 2 * psi * dpsi) - cp * psi * psi * dp);
        jac[0][j] = dalpha, jac[1][j] = dax, jac[2][j] = day;
        if (polar) {
            jac[1][j] = (nx * ay - ny * ax) * db + nx * dax + ny * day + dr * spin * spin
                        + 2 * r * spin * u5;
            jac[2][j] = (nx * day - ny * dax - (nx * ax + ny * ay) * db
                         - 2 * (drate * spin + rate * u5) - f[2] * dr) / r;
        }
    }
}

static int slopes(double t, N_Vector y, N_Vector out, void *piece)
{
    const double *now = N_VGetArrayPointer(y);
    double *rates = N_VGetArrayPointer(out), f[4];
    ((Piece *)piece)->evaluations++;
    motion(piece, now, f, NULL);
    for (int i = 0; i < 3; i++) rates[i] = now[3 + i], rates[3 + i] = f[i];
    return 0;
}

static int jacobian(double t, N_Vector y, N_Vector rates, SUNMatrix out, void *piece,
                    N_Vector unused1, N_Vector unused2, N_Vector unused3)
{
    double f[4], jac[3][6];
    ((Piece *)piece)->evaluations++;
    motion(piece, N_VGetArrayPointer(y), f, jac);
    for (int i = 0; i < 3; i++) {
        SM_ELEMENT_D(out, i, 3 + i) = 1; /* CVODE has set the others to 0 */
        for (int j = 0; j < 6; j++) SM_ELEMENT_D(out, 3 + i, j) = jac[i][j];
    }
    return 0;
}

static int overlap(double t, N_Vector y, double *depth, void *piece)
{
    const Piece *s = piece;
    const double *now = N_VGetArrayPointer(y);
    *depth = s->contact && s->polar ? now[1] : hypot(now[1], now[2]) - s->p->clearance;
    return 0;
}

/* Begin contact or flight at a root: other coordinates, if contact has its own. */
static void turn(Piece *s, double *y)
{
    const double clearance = s->p->clearance;
    if (s->contact && s->polar) {
        const double nx = cos(y[2]), ny = sin(y[2]), rate = y[4], across = clearance * y[5];
        y[1] = clearance * nx, y[2] = clearance * ny;
        y[4] = rate * nx - across * ny, y[5] = rate * ny + across * nx;
    } else if (!s->contact) {
        const double r = hypot(y[1], y[2]), nx = y[1] / r, ny = y[2] / r;
        const double rate = nx * y[4] + ny * y[5], across = nx * y[5] - ny * y[4];
        if (rate <= 0) return; /* it grazes, and goes on in flight */
        s->approach = rate;
        if (s->polar) y[1] = 0, y[2] = atan2(ny, nx), y[4] = rate, y[5] = across / clearance;
    }
    s->contact = !s->contact;
}

/* Maximum of the cubic through two forces and their rates at a distance h, first rising, then not. */
static double summit(double h, double force, double growth, double next, double next_growth)
{
    const double mean = (next - force) / h;
    const double c = 3 * mean - 2 * growth - next_growth, d = growth + next_growth - 2 * mean;
    const double x = growth / (sqrt(c * c - 3 * d * growth) - c); /* growth + 2 c x + 3 d x^2 = 0 */
    return force + h * x * (growth + x * (c + x * d));
}

/* Slider's acceleration at equal times after t = 0, and then the number of evaluations; returns the
 * number of impacts, or CVODE's error, which is negative. `tolerances` are absolute, of y in flight
 * and then in contact. `peaks`, unless NULL, becomes the maximum normal force, and that of the first
 * contact, from the force and its rate at the ends of the steps.
 */
int run(const double *constants, double scale, const double *start, int polar, double duration,
        int outputs, double relative, const double *tolerances, double newton, int order,
        double *found, double *peaks)
{
    SUNContext context;
    SUNContext_Create(NULL, &context);
    N_Vector y = N_VNew_Serial(6, context), seen = N_VNew_Serial(6, context);
    N_Vector absolute = N_VNew_Serial(6, context);
    SUNMatrix matrix = SUNDenseMatrix(6, 6, context);
    SUNLinearSolver solver = SUNLinSol_Dense(y, matrix, context);
    double *now = N_VGetArrayPointer(y), t = 0, f[4];
    Piece piece = {(const Constants *)constants, scale, INFINITY, 0, polar, 0, 0, 0};
    double before = 0, force = 0, growth = 0;
    for (int i = 0; i < 6; i++) now[i] = start[i];
    void *cvode = CVodeCreate(CV_BDF, context);
    CVodeInit(cvode, slopes, 0, y);
    CVodeSetErrFile(cvode, NULL);
    CVodeSetUserData(cvode, &piece);
    CVodeSetLinearSolver(cvode, solver, matrix);
    CVodeSetJacFn(cvode, jacobian);
    CVodeSetMaxNumSteps(cvode, -1);
    CVodeSetMaxOrd(cvode, order);
    CVodeSetNonlinConvCoef(cvode, newton);
    CVodeRootInit(cvode, 1, overlap);
    CVodeSetNoInactiveRootWarn(cvode);
    int impacts = 0, status = CV_ROOT_RETURN;
    for (int done = 0; done < outputs && status >= 0;) {
        if (status == CV_ROOT_RETURN) { /* a new piece, with tolerances of its own */
            int direction = piece.contact ? -1 : 1;
            const double *own = tolerances + 6 * piece.contact;
            for (int i = 0; i < 6; i++) N_VGetArrayPointer(absolute)[i] = own[i];
            CVodeReInit(cvode, t, y);
            CVodeSVtolerances(cvode, relative, absolute);
            CVodeSetRootDirection(cvode, &direction);
        }
        status = CVode(cvode, duration, y, &t, CV_ONE_STEP);
        for (; done < outputs && status >= 0; done++) {
            const double at = duration * (done + 1) / outputs;
            if (at > t) break;
            CVodeGetDky(cvode, at, 0, seen);
            motion(&piece, N_VGetArrayPointer(seen), f, NULL);
            found[done] = f[3];
        }
        if (peaks && piece.contact) {
            motion(&piece, now, f, NULL);
            if (growth > 0 && piece.growth <= 0) {
                const double peak = summit(t - before, force, growth, piece.force, piece.growth);
                if (peak > peaks[0]) peaks[0] = peak;
                if (impacts == 1 && peak > peaks[1]) peaks[1] = peak;
            }
            force = piece.force, growth = piece.growth;
        }
        before = t;
        if (status == CV_ROOT_RETURN) {
            impacts += !piece.contact;
            turn(&piece, now);
            motion(&piece, now, f, NULL);
            force = piece.force, growth = piece.growth;
        }
    }
    found[outputs] = piece.evaluations;
    CVodeFree(&cvode);
    SUNLinSolFree(solver);
    SUNMatDestroy(matrix);
    N_VDestroy(y), N_VDestroy(seen), N_VDestroy(absolute);
    SUNContext_Free(&context);
    return status < 0 ? status : impacts;
}
