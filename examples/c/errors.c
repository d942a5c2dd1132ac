/* What C gets wrong is a status and a message, never a crash: every kind of bad argument once. Run under valgrind in .ci/run. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "cellfan.h"

static int failures = 0;

static void expect_(CellfanStatus found, CellfanStatus expected, const char *text, int line) {
    if (found != expected || (text && !strstr(cellfan_last_error(), text))) {
        fprintf(stderr, "line %d: status %d, not %d: \"%s\" for \"%s\"\n", line, found, expected, cellfan_last_error(), text);
        failures++;
    }
}
#define EXPECT(call, status, text) expect_(call, status, text, __LINE__)

static float xyz[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
static uint32_t corners[8] = {0, 1, 2, 3, 1, 2, 3, 4};
static float values[5] = {0, 1, 2, 3, 4};

static CellfanSlice floats(const void *data, size_t len) { return (CellfanSlice){data, len, CELLFAN_TYPE_F32}; }
static CellfanSlice numbers(const void *data, size_t len) { return (CellfanSlice){data, len, CELLFAN_TYPE_U32}; }

static CellfanMesh good(void) {
    CellfanMesh mesh = {0};
    mesh.positions = floats(xyz, 15);
    mesh.connectivity = numbers(corners, 8);
    mesh.kind = 10;
    mesh.scalars = floats(values, 5);
    return mesh;
}

static void bad_mesh(CellfanMesh mesh, CellfanStatus status, const char *text, int line) {
    CellfanSession *session = (CellfanSession *)&failures;
    expect_(cellfan_session_new(&mesh, 1, &session), status, text, line);
    if (session != (CellfanSession *)&failures) failures++; /* left as it was */
}
#define BAD(change, status, text) do { CellfanMesh mesh = good(); change; bad_mesh(mesh, status, text, __LINE__); } while (0)

static CellfanSession *cancelled_by;
static void cancel(double share, void *user) {
    (void)share;
    (void)user;
    cellfan_session_cancel(cancelled_by);
}

static CellfanStatus from_inside;
static void call_back(double share, void *user) {
    (void)share;
    from_inside = cellfan_session_value_range(user, (double[2]){0});
}

int main(void) {
    if (strlen(cellfan_last_error()) != 0) failures++;

    /* Null, short and long. */
    BAD(mesh.positions.data = NULL, CELLFAN_STATUS_ARGUMENT, "positions");
    BAD(mesh.connectivity.data = NULL, CELLFAN_STATUS_ARGUMENT, "connectivity");
    BAD(mesh.scalars.data = NULL, CELLFAN_STATUS_ARGUMENT, "scalars");
    BAD(mesh.positions.len = 14, CELLFAN_STATUS_MESH, "coordinates");
    BAD(mesh.positions.len = 12, CELLFAN_STATUS_MESH, "only 4 points");
    BAD(mesh.positions.len = 0, CELLFAN_STATUS_MESH, NULL);
    BAD(mesh.connectivity.len = 7, CELLFAN_STATUS_MESH, "connectivity of 4");
    BAD(mesh.connectivity.len = 0, CELLFAN_STATUS_MESH, "no cell");
    BAD(mesh.connectivity.len = SIZE_MAX, CELLFAN_STATUS_ARGUMENT, "more than memory");
    BAD(mesh.scalars.len = 4, CELLFAN_STATUS_MESH, "scalars");
    BAD(mesh.y = floats(xyz, 15), CELLFAN_STATUS_ARGUMENT, "z");
    BAD((mesh.y = floats(xyz, 15), mesh.z = floats(xyz, 3)), CELLFAN_STATUS_MESH, "z coordinates");
    BAD(mesh.positions.data = (const char *)xyz + 1, CELLFAN_STATUS_ARGUMENT, "aligned");
    EXPECT(cellfan_session_new(NULL, 1, &cancelled_by), CELLFAN_STATUS_ARGUMENT, "mesh");
    CellfanMesh mesh = good();
    EXPECT(cellfan_session_new(&mesh, 1, NULL), CELLFAN_STATUS_ARGUMENT, "session");

    /* Types and kinds. */
    BAD(mesh.positions.type = 0, CELLFAN_STATUS_ARGUMENT, "no type");
    BAD(mesh.positions.type = CELLFAN_TYPE_U32, CELLFAN_STATUS_ARGUMENT, "no type");
    BAD(mesh.connectivity.type = CELLFAN_TYPE_F32, CELLFAN_STATUS_ARGUMENT, "no type");
    BAD(mesh.scalars.type = 99, CELLFAN_STATUS_ARGUMENT, "no type");
    BAD(mesh.association = 2, CELLFAN_STATUS_ARGUMENT, "association");
    BAD(mesh.kind = 9, CELLFAN_STATUS_ARGUMENT, "kind");
    BAD(mesh.dims[0] = 5, CELLFAN_STATUS_MESH, NULL);
    BAD((mesh.dims[0] = SIZE_MAX, mesh.dims[1] = SIZE_MAX, mesh.dims[2] = 2), CELLFAN_STATUS_MESH, NULL);
    uint8_t types[2] = {10, 77};
    int64_t offsets[3] = {0, 4, 9};
    CellfanSlice of_types = {types, 2, CELLFAN_TYPE_U8}, of_offsets = {offsets, 3, CELLFAN_TYPE_I64};
    BAD((mesh.types = of_types, mesh.offsets = of_offsets), CELLFAN_STATUS_MESH, "cell 1");
    BAD((mesh.types = of_types, mesh.offsets = of_offsets, mesh.offsets.len = 2), CELLFAN_STATUS_MESH, "offsets");
    BAD((mesh.types = of_types, mesh.types.type = CELLFAN_TYPE_I8), CELLFAN_STATUS_ARGUMENT, "uint8_t");

    /* Numbers that are none, points that are none. */
    corners[5] = 5;
    BAD(, CELLFAN_STATUS_MESH, "cell 1 refers to point 5");
    corners[5] = UINT32_MAX;
    BAD(mesh.connectivity.type = CELLFAN_TYPE_I32, CELLFAN_STATUS_MESH, "cell 1");
    corners[5] = 2;
    xyz[4] = NAN;
    BAD(, CELLFAN_STATUS_MESH, "not finite");
    xyz[4] = 0;
    for (int i = 0; i < 5; i++) values[i] = NAN;
    BAD(, CELLFAN_STATUS_SCALARS, "no finite value");
    for (int i = 0; i < 5; i++) values[i] = (float)i;

    /* A session that is right, and calls that are not. */
    CellfanSession *session = NULL;
    EXPECT(cellfan_session_new(&mesh, 1, &session), CELLFAN_STATUS_OK, NULL);
    CellfanCamera camera;
    CellfanControlPoint points[64];
    CellfanOptions options = {0};
    float rgba[16 * 16 * 4];
    size_t len = 0, rgba_len = 16 * 16 * 4;
    EXPECT(cellfan_camera_framing(session, 30, 20, 16, 16, NULL), CELLFAN_STATUS_ARGUMENT, "camera");
    EXPECT(cellfan_camera_framing(session, 30, 20, 0, 16, &camera), CELLFAN_STATUS_CAMERA, NULL);
    EXPECT(cellfan_camera_framing(session, NAN, 20, 16, 16, &camera), CELLFAN_STATUS_CAMERA, NULL);
    EXPECT(cellfan_camera_framing(session, 30, 20, 16, 16, &camera), CELLFAN_STATUS_OK, NULL);
    EXPECT(cellfan_preset(session, NULL, points, 64, &len), CELLFAN_STATUS_ARGUMENT, "name");
    EXPECT(cellfan_preset(session, "jet", points, 64, &len), CELLFAN_STATUS_TRANSFER, "viridis");
    EXPECT(cellfan_preset(session, "\xff", points, 64, &len), CELLFAN_STATUS_ARGUMENT, "UTF-8");
    EXPECT(cellfan_preset(session, "viridis", points, 1, &len), CELLFAN_STATUS_ARGUMENT, "room");
    EXPECT(cellfan_preset(session, "viridis", NULL, 64, &len), CELLFAN_STATUS_ARGUMENT, "points");
    EXPECT(cellfan_preset(session, "viridis", points, 64, &len), CELLFAN_STATUS_OK, NULL);
    EXPECT(cellfan_session_render(session, NULL, points, len, NULL, rgba, rgba_len, NULL), CELLFAN_STATUS_ARGUMENT, "camera");
    EXPECT(cellfan_session_render(session, &camera, NULL, len, NULL, rgba, rgba_len, NULL), CELLFAN_STATUS_ARGUMENT, "points");
    EXPECT(cellfan_session_render(session, &camera, points, 0, NULL, rgba, rgba_len, NULL), CELLFAN_STATUS_TRANSFER, NULL);
    EXPECT(cellfan_session_render(session, &camera, points, len, NULL, NULL, rgba_len, NULL), CELLFAN_STATUS_ARGUMENT, "rgba");
    EXPECT(cellfan_session_render(session, &camera, points, len, NULL, rgba, rgba_len - 1, NULL), CELLFAN_STATUS_ARGUMENT, "rgba");
    points[1].value = NAN;
    EXPECT(cellfan_session_render(session, &camera, points, len, NULL, rgba, rgba_len, NULL), CELLFAN_STATUS_TRANSFER, NULL);
    EXPECT(cellfan_preset(session, "viridis", points, 64, &len), CELLFAN_STATUS_OK, NULL);
    options.model = 4;
    EXPECT(cellfan_session_render(session, &camera, points, len, &options, rgba, rgba_len, NULL), CELLFAN_STATUS_ARGUMENT, "model");
    options.model = 0, options.sort = 77;
    EXPECT(cellfan_session_render(session, &camera, points, len, &options, rgba, rgba_len, NULL), CELLFAN_STATUS_ARGUMENT, "sort");
    options.sort = 0, options.memory_bytes = 10;
    EXPECT(cellfan_session_render(session, &camera, points, len, &options, rgba, rgba_len, NULL), CELLFAN_STATUS_MEMORY, "bytes");
    CellfanCamera blind = camera;
    memcpy(blind.target, blind.eye, sizeof blind.eye);
    EXPECT(cellfan_session_render(session, &blind, points, len, NULL, rgba, rgba_len, NULL), CELLFAN_STATUS_CAMERA, NULL);
    EXPECT(cellfan_session_value_range(session, NULL), CELLFAN_STATUS_ARGUMENT, "range");
    EXPECT(cellfan_session_bounds(session, NULL), CELLFAN_STATUS_ARGUMENT, "bounds");
    EXPECT(cellfan_session_update_scalars(session, 0, floats(values, 4)), CELLFAN_STATUS_SCALARS, "scalars");
    EXPECT(cellfan_session_update_scalars(session, 7, floats(values, 5)), CELLFAN_STATUS_ARGUMENT, "association");
    EXPECT(cellfan_session_update_scalars(session, 0, floats(NULL, 5)), CELLFAN_STATUS_ARGUMENT, "scalars");
    CellfanSlice none = {0};
    EXPECT(cellfan_session_update_positions(session, floats(xyz, 12), none, none), CELLFAN_STATUS_MESH, "points");
    EXPECT(cellfan_session_update_positions(session, none, none, none), CELLFAN_STATUS_ARGUMENT, "positions");
    EXPECT(cellfan_session_update_topology(session, NULL), CELLFAN_STATUS_ARGUMENT, "mesh");
    EXPECT(cellfan_save(NULL, 16, 16, rgba, rgba_len), CELLFAN_STATUS_ARGUMENT, "path");
    EXPECT(cellfan_save("picture.jpg", 16, 16, rgba, rgba_len), CELLFAN_STATUS_FILE, NULL);
    EXPECT(cellfan_save("/nowhere/picture.png", 16, 16, rgba, rgba_len), CELLFAN_STATUS_FILE, NULL);
    EXPECT(cellfan_save("picture.png", 16, 17, rgba, rgba_len), CELLFAN_STATUS_ARGUMENT, "rgba");

    /* After all of that it draws; a callback may cancel, and may not use the session. */
    EXPECT(cellfan_session_render(session, &camera, points, len, NULL, rgba, rgba_len, NULL), CELLFAN_STATUS_OK, NULL);
    EXPECT(cellfan_session_on_progress(session, cancel, NULL), CELLFAN_STATUS_OK, NULL);
    cancelled_by = session;
    EXPECT(cellfan_session_render(session, &camera, points, len, NULL, rgba, rgba_len, NULL), CELLFAN_STATUS_CANCELLED, "cancelled");
    EXPECT(cellfan_session_on_progress(session, call_back, session), CELLFAN_STATUS_OK, NULL);
    EXPECT(cellfan_session_render(session, &camera, points, len, NULL, rgba, rgba_len, NULL), CELLFAN_STATUS_OK, NULL);
    EXPECT(from_inside, CELLFAN_STATUS_BUSY, NULL);
    EXPECT(cellfan_session_on_progress(session, NULL, NULL), CELLFAN_STATUS_OK, NULL);
    EXPECT(cellfan_session_render(session, &camera, points, len, NULL, rgba, rgba_len, NULL), CELLFAN_STATUS_OK, NULL);

    /* Freed, null, and what never was a session. */
    EXPECT(cellfan_session_free(session), CELLFAN_STATUS_OK, NULL);
    EXPECT(cellfan_session_free(session), CELLFAN_STATUS_HANDLE, "freed");
    EXPECT(cellfan_session_free(NULL), CELLFAN_STATUS_HANDLE, "null");
    EXPECT(cellfan_session_cancel((CellfanSession *)&failures), CELLFAN_STATUS_HANDLE, "never was one");
    EXPECT(cellfan_session_render(session, &camera, points, len, NULL, rgba, rgba_len, NULL), CELLFAN_STATUS_HANDLE, "freed");
    EXPECT(cellfan_session_update_scalars(session, 0, floats(values, 5)), CELLFAN_STATUS_HANDLE, "freed");

    if (failures) fprintf(stderr, "%d failures\n", failures);
    else puts("every bad argument was told");
    return failures != 0;
}
