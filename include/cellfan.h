/* cellfan: renders volumetric simulation data by projecting its cells. docs/embedding.md is the guide.
 * Made from src/capi; do not edit. */

#ifndef CELLFAN_H
#define CELLFAN_H

#include <stddef.h>
#include <stdint.h>

// What became of a call. Every function that returns one leaves a message in cellfan_last_error() unless it is CELLFAN_STATUS_OK,
// and leaves what it would have written as it was.
enum CellfanStatus
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : int32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // It was done.
  CELLFAN_STATUS_OK = 0,
  // A pointer is null or not aligned, a number is none of its enumeration, a text is not UTF-8.
  CELLFAN_STATUS_ARGUMENT = 1,
  // The mesh: lengths that do not fit, numbers of points that do not exist, coordinates that are not finite, no cell with a volume.
  CELLFAN_STATUS_MESH = 2,
  // The scalars: of another length, or none of them finite.
  CELLFAN_STATUS_SCALARS = 3,
  // The camera cannot look at anything.
  CELLFAN_STATUS_CAMERA = 4,
  // The transfer function: values that do not ascend, extinction below 0.
  CELLFAN_STATUS_TRANSFER = 5,
  // Options that contradict each other or lie out of range.
  CELLFAN_STATUS_OPTION = 6,
  // The memory budget, or the system's memory, is too small.
  CELLFAN_STATUS_MEMORY = 7,
  // cellfan_session_cancel() was called.
  CELLFAN_STATUS_CANCELLED = 8,
  // A file could not be written.
  CELLFAN_STATUS_FILE = 9,
  // The session was freed, or never was one.
  CELLFAN_STATUS_HANDLE = 10,
  // The session is in use by another thread, or by the call whose callback this is.
  CELLFAN_STATUS_BUSY = 11,
  // A fault of cellfan's own; the session is best freed.
  CELLFAN_STATUS_FAULT = 12,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum CellfanStatus CellfanStatus;
#else
typedef int32_t CellfanStatus;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// The type of the values of a slice.
enum CellfanType
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // int8_t
  CELLFAN_TYPE_I8 = 1,
  // uint8_t
  CELLFAN_TYPE_U8 = 2,
  // int16_t
  CELLFAN_TYPE_I16 = 3,
  // uint16_t
  CELLFAN_TYPE_U16 = 4,
  // int32_t
  CELLFAN_TYPE_I32 = 5,
  // uint32_t
  CELLFAN_TYPE_U32 = 6,
  // int64_t
  CELLFAN_TYPE_I64 = 7,
  // uint64_t
  CELLFAN_TYPE_U64 = 8,
  // float
  CELLFAN_TYPE_F32 = 9,
  // double
  CELLFAN_TYPE_F64 = 10,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum CellfanType CellfanType;
#else
typedef uint32_t CellfanType;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What scalars belong to.
enum CellfanAssociation
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // One a point.
  CELLFAN_ASSOCIATION_POINTS = 0,
  // One a cell.
  CELLFAN_ASSOCIATION_CELLS = 1,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum CellfanAssociation CellfanAssociation;
#else
typedef uint32_t CellfanAssociation;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// What a pixel holds.
enum CellfanModel
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // Light and opacity, premultiplied.
  CELLFAN_MODEL_EMISSION_ABSORPTION = 0,
  // Transmitted intensity of four bands; a miss is 1.
  CELLFAN_MODEL_ABSORPTION = 1,
  // Light alone.
  CELLFAN_MODEL_EMISSION = 2,
  // The colour of the largest value.
  CELLFAN_MODEL_MIP = 3,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum CellfanModel CellfanModel;
#else
typedef uint32_t CellfanModel;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// How cells are put in order.
enum CellfanSort
#if defined(__cplusplus) || __STDC_VERSION__ >= 202311L
  : uint32_t
#endif // defined(__cplusplus) || __STDC_VERSION__ >= 202311L
 {
  // The cheapest that is exact.
  CELLFAN_SORT_AUTO = 0,
  // The order of the cells in memory.
  CELLFAN_SORT_NONE = 1,
  // Distance of the centroid.
  CELLFAN_SORT_CENTROID = 2,
  // Power distance to the circumsphere.
  CELLFAN_SORT_POWER = 3,
  // By the graph of shared faces.
  CELLFAN_SORT_TOPOLOGICAL = 4,
  // Every fragment checked.
  CELLFAN_SORT_EXACT = 5,
};
#ifndef __cplusplus
#if __STDC_VERSION__ >= 202311L
typedef enum CellfanSort CellfanSort;
#else
typedef uint32_t CellfanSort;
#endif // __STDC_VERSION__ >= 202311L
#endif // __cplusplus

// A session; only ever behind a pointer, which is a number and points nowhere.
typedef struct CellfanSession CellfanSession;

// `len` values of `type` from `data` on; no values where `data` is null and `len` 0.
typedef struct CellfanSlice {
  // The first value; aligned for its type.
  const void *data;
  // How many values.
  size_t len;
  // A CellfanType.
  uint32_t type;
} CellfanSlice;

// A mesh. Clear it (`CellfanMesh mesh = {0};`), then set what it has.
//
// Structured where `dims` are set: as many points along i, j and k, i fastest, and no connectivity. Of several kinds where `types`
// are set, as VTK's unstructured grids. Of one kind otherwise.
typedef struct CellfanMesh {
  // x, y, z of one point after the other, float or double; where `y` and `z` are set, x alone.
  struct CellfanSlice positions;
  // y of all points, of the type of `positions`.
  struct CellfanSlice y;
  // z of all points.
  struct CellfanSlice z;
  // The points of one cell after the other, from 0, in VTK's order: uint32_t, int32_t, uint64_t or int64_t.
  struct CellfanSlice connectivity;
  // Where all cells are of one kind, VTK's code of it: 10 tetrahedra, 11 voxels, 12 hexahedra, 13 wedges, 14 pyramids.
  uint32_t kind;
  // VTK's code of each cell, uint8_t.
  struct CellfanSlice types;
  // With `types`: where in `connectivity` each cell begins, and the end; one more than there are cells, of a type of `connectivity`.
  struct CellfanSlice offsets;
  // Points along i, j and k; 0 where the mesh is not structured.
  size_t dims[3];
  // What is drawn, of any type; none draws the mesh homogeneous.
  struct CellfanSlice scalars;
  // A CellfanAssociation: what the scalars belong to.
  uint32_t association;
} CellfanMesh;

// A camera in world coordinates; pixel (x, y) runs right and down.
typedef struct CellfanCamera {
  // Where the eye is.
  double eye[3];
  // The point in the middle of the picture.
  double target[3];
  // Up in the picture.
  double up[3];
  // Vertical field of view in degrees; 0 for parallel rays.
  double fov_degrees;
  // What the picture's height covers with parallel rays, in world units.
  double height_world;
  // In pixels.
  uint32_t width;
  // In pixels.
  uint32_t height;
  // Nothing nearer than this view depth is drawn; 0 for the default, a millionth of the mesh's diagonal.
  double near;
  // Nothing farther than this is drawn; 0 for no limit.
  double far;
} CellfanCamera;

// A point of a transfer function, which is linear between points; values ascend.
typedef struct CellfanControlPoint {
  // The scalar.
  double value;
  // Linear red, green, blue.
  double color[3];
  // Extinction per world unit length.
  double extinction;
} CellfanControlPoint;

// What to draw. All 0 is the default.
typedef struct CellfanOptions {
  // A CellfanModel.
  uint32_t model;
  // A CellfanSort.
  uint32_t sort;
  // What the session and a picture may hold in bytes, arrays of the caller's aside; 0 for any amount.
  uint64_t memory_bytes;
} CellfanOptions;

// What a picture took.
typedef struct CellfanStats {
  // Cells that were drawn.
  uint64_t drawn;
  // Cells without extinction.
  uint64_t culled_transparent;
  // Cells outside of the picture.
  uint64_t culled_outside;
  // Cells with a value that is not finite.
  uint64_t invalid;
  // Cells without volume.
  uint64_t degenerate;
  // 1 where the order of cells is exact in every pixel.
  uint32_t is_exact;
  // Wall time in milliseconds.
  double frame_ms;
} CellfanStats;

// Called with the share of a picture that is done, from 0 to 1, and `user`: by one thread at a time, which need not be the one that
// draws. It may call cellfan_session_cancel(); it must return, and throw nothing.
typedef void (*CellfanProgress)(double share, void *user);

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// What went wrong last in a call on this thread; empty if nothing did. Good until the next call on this thread. Never null.
//
// Threads: any; each has its own.
const char *cellfan_last_error(void);

// Makes a session that draws `mesh` on `threads` threads of its own, which sleep between pictures; 0 for one a core.
//
// Positions of type float with x, y, z together and connectivity in 32 bits are used in place: they have to stay where they are,
// unchanged, until the session is freed or the mesh replaced. Scalars are read before this returns.
//
// Threads: any.
//
// # Safety
// `mesh` is null or points to a mesh whose slices have so many values; `session` is null or has room for a pointer.
CellfanStatus cellfan_session_new(const struct CellfanMesh *mesh,
                                  size_t threads,
                                  struct CellfanSession **session);

// Frees a session. A call of another thread that is using it goes on to its end; arrays have to stay until then.
//
// Threads: any. Freeing twice is CELLFAN_STATUS_HANDLE, and so is null.
CellfanStatus cellfan_session_free(struct CellfanSession *session);

// Draws other values, one a point or one a cell (`of`, a CellfanAssociation); they are read before this returns. Cells with a value
// that is not finite are left out. While the camera stays, the next picture needs no sort.
//
// Threads: any, one at a time for a session (CELLFAN_STATUS_BUSY).
//
// # Safety
// The slice has so many values.
CellfanStatus cellfan_session_update_scalars(struct CellfanSession *session,
                                             uint32_t of,
                                             struct CellfanSlice values);

// Moves the points, as many as there were: x, y, z together, or an axis a slice (else clear `y` and `z`). They are copied before
// this returns; those of the mesh are no longer used.
//
// Threads: any, one at a time for a session.
//
// # Safety
// The slices have so many values.
CellfanStatus cellfan_session_update_positions(struct CellfanSession *session,
                                               struct CellfanSlice x,
                                               struct CellfanSlice y,
                                               struct CellfanSlice z);

// Draws another mesh, as cellfan_session_new() does; threads and memory for pictures stay. After an error the mesh is that of before.
//
// Threads: any, one at a time for a session.
//
// # Safety
// That of cellfan_session_new().
CellfanStatus cellfan_session_update_topology(struct CellfanSession *session,
                                              const struct CellfanMesh *mesh);

// Draws a picture into `rgba`: red, green, blue, opacity of each pixel, linear and premultiplied, row by row from the top;
// `rgba_len` is 4 * width * height.
//
// `options` may be null for the default, `stats` where nobody asks.
//
// Threads: any, one at a time for a session.
//
// # Safety
// Pointers are null or have what they say: `points_len` control points, `rgba_len` values.
CellfanStatus cellfan_session_render(struct CellfanSession *session,
                                     const struct CellfanCamera *camera,
                                     const struct CellfanControlPoint *points,
                                     size_t points_len,
                                     const struct CellfanOptions *options,
                                     float *rgba,
                                     size_t rgba_len,
                                     struct CellfanStats *stats);

// Ends the picture that is being drawn, or the next, within milliseconds: its call returns CELLFAN_STATUS_CANCELLED.
//
// Threads: any, at any time.
CellfanStatus cellfan_session_cancel(struct CellfanSession *session);

// Has `call` called while pictures are drawn; a null function ends it.
//
// Threads: any, one at a time for a session.
CellfanStatus cellfan_session_on_progress(struct CellfanSession *session, CellfanProgress call, void *user);

// Smallest and largest finite scalar, into two values.
//
// Threads: any, one at a time for a session.
//
// # Safety
// `range` is null or has room for two values.
CellfanStatus cellfan_session_value_range(struct CellfanSession *session, double *range);

// The box around the mesh, smallest x, y, z, then largest, into six values.
//
// Threads: any, one at a time for a session.
//
// # Safety
// `bounds` is null or has room for six values.
CellfanStatus cellfan_session_bounds(struct CellfanSession *session, double *bounds);

// The version of cellfan, such as "0.1.0".
//
// Threads: any.
const char *cellfan_version(void);

// A camera that shows the whole mesh, from azimuth and elevation in degrees, +z up.
//
// Threads: any, one at a time for a session.
//
// # Safety
// `camera` is null or has room for one.
CellfanStatus cellfan_camera_framing(struct CellfanSession *session,
                                     double azimuth_degrees,
                                     double elevation_degrees,
                                     uint32_t width,
                                     uint32_t height,
                                     struct CellfanCamera *camera);

// The control points of a colour map ("viridis", "inferno", "cool-warm", "x-ray") over the scalars of a session, more opaque where
// they are larger; at most `capacity` of them into `points` (64 are enough), how many into `points_len`.
//
// Threads: any, one at a time for a session.
//
// # Safety
// `name` is null or ends with 0, `points` has room for `capacity` of them, `points_len` is null or has room for a number.
CellfanStatus cellfan_preset(struct CellfanSession *session,
                             const char *name,
                             struct CellfanControlPoint *points,
                             size_t capacity,
                             size_t *points_len);

// Writes a picture to a file: .png (straight alpha), .exr or .npy, by the extension of `path`. It appears whole or not at all.
//
// Threads: any.
//
// # Safety
// `path` is null or ends with 0, `rgba` is null or has `rgba_len` values.
CellfanStatus cellfan_save(const char *path,
                           uint32_t width,
                           uint32_t height,
                           const float *rgba,
                           size_t rgba_len);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* CELLFAN_H */
