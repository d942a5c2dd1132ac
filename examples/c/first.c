/* A first picture from C: a solver's tetrahedra, drawn at every step in the solver's own memory.
 * Build: see README.md in this folder. Run: first OUT.png. Checks what it draws; exit code 0 if all is right. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "cellfan.h"

enum { N = 12, WIDTH = 96, HEIGHT = 72 };

static int check(CellfanStatus status, const char *what) {
    if (status != CELLFAN_STATUS_OK) fprintf(stderr, "%s: %s\n", what, cellfan_last_error());
    return status != CELLFAN_STATUS_OK;
}

/* One point of a lattice of (N + 1)^3. */
static uint32_t point(int i, int j, int k) { return (uint32_t)(i + (N + 1) * (j + (N + 1) * k)); }

static void on_progress(double share, void *user) {
    double *last = user;
    if (share >= *last || share == 0.0) *last = share;
}

int main(int argc, char **argv) {
    size_t points = (N + 1) * (N + 1) * (N + 1), cells = (size_t)N * N * N * 6;
    float *xyz = malloc(points * 3 * sizeof *xyz), *rgba = malloc(WIDTH * HEIGHT * 4 * sizeof *rgba);
    uint32_t *corners = malloc(cells * 4 * sizeof *corners), *next = corners;
    double *pressure = malloc(points * sizeof *pressure), range[2], bounds[6], last = 0.0;
    if (!xyz || !rgba || !corners || !pressure) return 2;

    for (int k = 0; k <= N; k++)
        for (int j = 0; j <= N; j++)
            for (int i = 0; i <= N; i++) {
                float *p = xyz + 3 * point(i, j, k);
                p[0] = (float)i / N, p[1] = (float)j / N, p[2] = (float)k / N;
            }
    /* Each box in six tetrahedra around its diagonal: one for each order of the three axes. */
    static const int order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    for (int box = 0; box < N * N * N; box++)
        for (int t = 0; t < 6; t++) {
            int at[3] = {box % N, box / N % N, box / (N * N)};
            *next++ = point(at[0], at[1], at[2]);
            for (int step = 0; step < 3; step++) {
                at[order[t][step]]++;
                *next++ = point(at[0], at[1], at[2]);
            }
        }

    CellfanMesh mesh = {0};
    mesh.positions = (CellfanSlice){xyz, 3 * points, CELLFAN_TYPE_F32};
    mesh.connectivity = (CellfanSlice){corners, 4 * cells, CELLFAN_TYPE_U32};
    mesh.kind = 10;
    CellfanSession *session = NULL;
    if (check(cellfan_session_new(&mesh, 2, &session), "session")) return 1;
    if (check(cellfan_session_bounds(session, bounds), "bounds")) return 1;
    if (bounds[0] != 0.0 || bounds[5] != 1.0) return 1;
    if (check(cellfan_session_on_progress(session, on_progress, &last), "progress")) return 1;

    CellfanCamera camera;
    CellfanControlPoint colors[64];
    CellfanStats stats;
    size_t colors_len = 0;
    if (check(cellfan_camera_framing(session, 35.0, 20.0, WIDTH, HEIGHT, &camera), "camera")) return 1;
    for (int step = 0; step < 4; step++) {
        for (size_t p = 0; p < points; p++) pressure[p] = sin(6.0 * xyz[3 * p] + step) * cos(5.0 * xyz[3 * p + 1]);
        CellfanSlice values = {pressure, points, CELLFAN_TYPE_F64};
        if (check(cellfan_session_update_scalars(session, CELLFAN_ASSOCIATION_POINTS, values), "scalars")) return 1;
        if (check(cellfan_preset(session, "viridis", colors, 64, &colors_len), "preset")) return 1;
        if (check(cellfan_session_render(session, &camera, colors, colors_len, NULL, rgba, WIDTH * HEIGHT * 4, &stats),
                  "render"))
            return 1;
    }
    if (check(cellfan_session_value_range(session, range), "range")) return 1;
    const float *middle = rgba + 4 * (HEIGHT / 2 * WIDTH + WIDTH / 2);
    printf("cellfan %s: %llu cells in %.1f ms, values %.3f to %.3f, opacity in the middle %.3f\n", cellfan_version(),
           (unsigned long long)stats.drawn, stats.frame_ms, range[0], range[1], middle[3]);
    if (stats.drawn + stats.culled_transparent + stats.culled_outside != cells || !stats.is_exact) return 1;
    if (!(middle[3] > 0.05f && middle[3] < 1.0f) || last != 1.0) return 1;

    /* One colour, extinction 2 per unit: along x through the cube, opacity is 1 - exp(-2). */
    CellfanControlPoint even = {0.0, {1.0, 1.0, 1.0}, 2.0};
    CellfanCamera along = {{4.0, 0.5, 0.5}, {0.0, 0.5, 0.5}, {0.0, 0.0, 1.0}, 0.0, 0.5, 9, 9, 0.0, 0.0};
    if (check(cellfan_session_render(session, &along, &even, 1, NULL, rgba, 9 * 9 * 4, NULL), "render")) return 1;
    if (fabs(rgba[4 * 40 + 3] - (1.0 - exp(-2.0))) > 1e-5) return 1;

    /* The mesh moves: twice as long along x. */
    for (size_t p = 0; p < points; p++) xyz[3 * p] *= 2.0f;
    CellfanSlice moved = {xyz, 3 * points, CELLFAN_TYPE_F32}, none = {0};
    if (check(cellfan_session_update_positions(session, moved, none, none), "positions")) return 1;
    if (check(cellfan_session_render(session, &along, &even, 1, NULL, rgba, 9 * 9 * 4, NULL), "render")) return 1;
    if (fabs(rgba[4 * 40 + 3] - (1.0 - exp(-4.0))) > 1e-5) return 1;

    if (check(cellfan_session_render(session, &camera, colors, colors_len, NULL, rgba, WIDTH * HEIGHT * 4, NULL), "render"))
        return 1;
    if (argc > 1 && check(cellfan_save(argv[1], WIDTH, HEIGHT, rgba, WIDTH * HEIGHT * 4), argv[1])) return 1;
    if (check(cellfan_session_free(session), "free")) return 1;
    free(xyz), free(rgba), free(corners), free(pressure);
    return 0;
}
