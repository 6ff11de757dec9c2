/* Pointskin for C99, and for every language that calls C: oriented points in, watertight triangle mesh out.

   Objects are handles that psk_..._free() frees; NULL may be freed. Functions that can fail return a psk_code, 0 for
   success, and describe the failure in the psk_error that is their last parameter, which may be NULL. There is no
   global state, no function prints or exits, and no C++ exception comes out. A handle and all that was made in its
   workspace belong to one thread at a time; different workspaces may work side by side.

   Structs of options and reports begin with their size, which psk_init() sets together with the defaults:

       psk_options options;
       PSK_INIT(options);                (the same as psk_init(PSK_STRUCT_OPTIONS, &options, sizeof(options), NULL))
       options.depth = 9;

   Later versions only add members behind those that are there. A library that is newer than its caller takes the
   defaults for what the caller does not know, and writes no more than the caller's size; one that is older refuses a
   struct whose unknown members are not zero. PSK_C_ABI counts changes that callers must be compiled for again.

   What the options mean in full, their ranges, costs and sources stand in the headers of C++ that are named at each
   struct; names and defaults are the same. Results are the same bytes for any number of threads, any order of the
   points, CPU or GPU. */
#ifndef POINTSKIN_C_H
#define POINTSKIN_C_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32)
#define PSK_C_API
#else
#define PSK_C_API __attribute__((visibility("default")))
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* ---- Versions and errors ------------------------------------------------------------------------------------- */

#define PSK_VERSION_MAJOR 0
#define PSK_VERSION_MINOR 1
#define PSK_VERSION_PATCH 0
#define PSK_C_ABI 0

/* The version of the library that was loaded, "0.1.0". */
PSK_C_API const char* psk_version(void);

/* PSK_C_ABI of the library that was loaded. */
PSK_C_API int32_t psk_c_abi(void);

/* 1 if the library was built with CUDA. Says nothing about GPUs being present. */
PSK_C_API int32_t psk_built_with_cuda(void);

/* Result of a call. The values are the exit codes of the program. */
typedef int32_t psk_code;
enum {
  PSK_OK = 0,
  PSK_INTERNAL = 1,           /* a bug or a failed internal check */
  PSK_USAGE = 2,              /* an argument or option outside of its range */
  PSK_INVALID_INPUT = 3,      /* a file or an array that is not what it claims */
  PSK_NO_NORMALS = 4,         /* points without usable normals */
  PSK_EMPTY_RESULT = 5,       /* nothing to reconstruct, or a surface without triangles */
  PSK_OVER_LIMIT = 6,         /* more memory or more indices than allowed */
  PSK_DEVICE_UNAVAILABLE = 7, /* the asked-for device does not exist or failed */
  PSK_OUTPUT_NOT_WRITTEN = 8, /* the output could not be written; nothing was replaced */
  PSK_INTERRUPTED = 130       /* cancelled by the progress callback */
};

/* What went wrong: one sentence that says what failed, where, and what helps. Never changes its layout. */
typedef struct psk_error {
  psk_code code;
  char message[1020]; /* ends in 0; cut off where it is longer */
} psk_error;

/* Called a few times per run from the calling thread. phase: "octree", "splat", "solve", "extract"; of normals "estimate",
   "propagate", "iterate". fraction: of the whole run, in [0, 1], never decreasing. Returning 0 cancels the run, which
   then fails with PSK_INTERRUPTED. */
typedef int32_t (*psk_progress)(const char* phase, double fraction, void* user);

/* ---- Structs that know their size ---------------------------------------------------------------------------- */

enum {
  PSK_STRUCT_OPTIONS = 1,
  PSK_STRUCT_NORMAL_OPTIONS = 2,
  PSK_STRUCT_READ_OPTIONS = 3,
  PSK_STRUCT_WRITE_OPTIONS = 4,
  PSK_STRUCT_POINTS = 5,
  PSK_STRUCT_TRIANGLES = 6,
  PSK_STRUCT_RUN_REPORT = 7,
  PSK_STRUCT_NORMAL_REPORT = 8,
  PSK_STRUCT_MESH_REPORT = 9,
  PSK_STRUCT_COMPARE_OPTIONS = 10,
  PSK_STRUCT_COMPARISON = 11,
  PSK_STRUCT_RENDER_OPTIONS = 12,
  PSK_STRUCT_RENDER_REPORT = 13,
  PSK_STRUCT_PROBLEM_OPTIONS = 14,
  PSK_STRUCT_PROBLEM = 15,
  PSK_STRUCT_EDIT_OPTIONS = 16,
  PSK_STRUCT_OPERATION = 17,
  PSK_STRUCT_STEP_REPORT = 18,
  PSK_STRUCT_HANDLE = 19,
  PSK_STRUCT_LATTICE = 20,
  PSK_STRUCT_DEFORM_REPORT = 21,
  PSK_STRUCT_BOOLEAN_OPTIONS = 22,
  PSK_STRUCT_BOOLEAN_REPORT = 23,
  PSK_STRUCT_FLUID_OPTIONS = 24,
  PSK_STRUCT_FLUID_REPORT = 25,
  PSK_STRUCT_DEPTH_SUGGESTION = 26,
  PSK_STRUCT_SCALE_OPTIONS = 27,
  PSK_STRUCT_COUNT = 27
};

/* Bytes of a struct in this library; 0 for a kind that it does not know. */
PSK_C_API size_t psk_struct_size(int32_t kind);

/* Fills `bytes` bytes at `target` with the defaults of a struct, its first member with `bytes`.
   Fails with PSK_USAGE for an unknown kind, or fewer bytes than the first version of the struct had. */
PSK_C_API psk_code psk_init(int32_t kind, void* target, size_t bytes, psk_error* error);

/* ---- Workspaces: where work is done -------------------------------------------------------------------------- */

/* A device with a stream and a pool of memory that is used again. See workspace.hpp. */
typedef struct psk_workspace psk_workspace;

/* device: "auto" (the first GPU if one answers, else the CPU), "cpu", "cuda", "cuda:N", or several
   GPUs as one: "cuda:N,M", "cuda:all"; NULL is "auto".
   threads: of the CPU; 0: all that the process may use.
   Fails with PSK_USAGE or PSK_DEVICE_UNAVAILABLE. */
PSK_C_API psk_code psk_workspace_create(const char* device, int32_t threads, psk_workspace** workspace,
                                        psk_error* error);

/* Work of GPU number `gpu` goes to `cuda_stream`, a cudaStream_t (NULL: the default stream) that must outlive the
   workspace and all that is made in it. */
PSK_C_API psk_code psk_workspace_create_on_stream(int32_t gpu, void* cuda_stream, psk_workspace** workspace,
                                                  psk_error* error);
PSK_C_API void psk_workspace_free(psk_workspace* workspace);

/* The GPU's number, of several as one the first's, or -1 for the CPU. */
PSK_C_API int32_t psk_workspace_gpu(const psk_workspace* workspace);
/* A name for people, such as "NVIDIA H200" or "CPU, 2 threads"; valid as long as the workspace. */
PSK_C_API const char* psk_workspace_device_name(const psk_workspace* workspace);
/* The cudaStream_t; NULL on the CPU. */
PSK_C_API void* psk_workspace_stream(const psk_workspace* workspace);
/* Memory of the device that is free now, bytes; of several GPUs as one as many times that of the one with the least. */
PSK_C_API int64_t psk_workspace_available_bytes(const psk_workspace* workspace);
/* What all arrays of the workspace hold now, bytes. */
PSK_C_API int64_t psk_workspace_held_bytes(const psk_workspace* workspace);
/* Waits until the stream's work is done. */
PSK_C_API psk_code psk_workspace_synchronize(psk_workspace* workspace, psk_error* error);
/* Gives memory that is kept for the next run back to the system. */
PSK_C_API void psk_workspace_release_memory(psk_workspace* workspace);

/* ---- Arrays -------------------------------------------------------------------------------------------------- */

/* Types of scalars, in the order of AttributeType (attribute.hpp). */
enum {
  PSK_INT8 = 0,
  PSK_UINT8 = 1,
  PSK_INT16 = 2,
  PSK_UINT16 = 3,
  PSK_INT32 = 4,
  PSK_UINT32 = 5,
  PSK_INT64 = 6,
  PSK_UINT64 = 7,
  PSK_FLOAT32 = 8,
  PSK_FLOAT64 = 9
};

enum {
  PSK_HOST = 0,  /* the memory of the process */
  PSK_DEVICE = 1 /* the memory of the workspace's GPU, or such as all of its GPUs reach */
};

/* Numbers in somebody's memory: shape (rows, components). Element (i, j) lies at data + i row_stride + j
   component_stride; strides are bytes of any sign, and both 0 for a packed array. Never changes its layout. */
typedef struct psk_array {
  const void* data; /* NULL: there is no such array */
  int64_t rows;
  int64_t row_stride, component_stride;
  int32_t components;
  int32_t type;     /* PSK_FLOAT32 ... */
  int32_t memory;   /* PSK_HOST or PSK_DEVICE */
  int32_t reserved; /* 0 */
} psk_array;

/* A named scalar of points or vertices. Never changes its layout. */
typedef struct psk_attribute {
  const char* name;       /* UTF-8 */
  psk_array values;       /* shape (n, 1) */
  const uint8_t* missing; /* shape (n), packed, where the values are: 1 where an integer is missing; NULL: none is */
} psk_attribute;

/* Points in the caller's memory, which is read and never written. */
typedef struct psk_points {
  size_t size;
  psk_array positions; /* shape (n, 3), any type; world units, relative to `origin` */
  psk_array normals;   /* shape (n, 3), outward, any length; data NULL: there are none */
  const psk_attribute* attributes;
  int64_t attribute_count;
  double origin[3]; /* added to every position */
} psk_points;

/* Triangles in the caller's memory. */
typedef struct psk_triangles {
  size_t size;
  const psk_points* vertices;
  psk_array triangles; /* shape (t, 3), any type of integers; ids in [0, n), counter-clockwise seen from outside */
} psk_triangles;

/* ---- Clouds -------------------------------------------------------------------------------------------------- */

/* Points on the host. See cloud.hpp. */
typedef struct psk_cloud psk_cloud;

typedef struct psk_read_options {
  size_t size;
  const double* shift; /* (3): the offset to subtract before float is used; NULL: chosen (io.hpp) */
  int32_t threads;     /* 0: all */
} psk_read_options;

/* Copies points into a cloud. Rows with a coordinate that is not finite are left out and counted (psk_cloud_dropped). An
   offset is taken off coordinates that float does not hold exactly enough, as when files are read (io.hpp). Arrays
   must be PSK_HOST. options: NULL for the defaults. Fails with PSK_USAGE where shapes do not fit together. O(n). */
PSK_C_API psk_code psk_cloud_create(const psk_points* points, const psk_read_options* options, psk_cloud** cloud,
                                    psk_error* error);
/* Reads a file in any format of docs/formats.md; "-" is stdin. Fails with PSK_INVALID_INPUT. */
PSK_C_API psk_code psk_cloud_read(const char* path, const psk_read_options* options, psk_cloud** cloud,
                                  psk_error* error);
PSK_C_API psk_code psk_cloud_copy(const psk_cloud* cloud, psk_cloud** copy, psk_error* error);
PSK_C_API void psk_cloud_free(psk_cloud* cloud);

PSK_C_API int64_t psk_cloud_size(const psk_cloud* cloud);
/* Points of the source that were left out because a coordinate was not finite. */
PSK_C_API int64_t psk_cloud_dropped(const psk_cloud* cloud);
/* World position of point i = origin + positions[i]. */
PSK_C_API void psk_cloud_origin(const psk_cloud* cloud, double origin[3]);
/* Views of the cloud's own memory, valid until it is changed or freed. (n, 3) float32; normals: data NULL if none. */
PSK_C_API psk_array psk_cloud_positions(const psk_cloud* cloud);
PSK_C_API psk_array psk_cloud_normals(const psk_cloud* cloud);
PSK_C_API int64_t psk_cloud_attribute_count(const psk_cloud* cloud);
/* Attribute number `index`, counted from 0; name NULL for one that there is not. */
PSK_C_API psk_attribute psk_cloud_attribute(const psk_cloud* cloud, int64_t index);

/* Adds copies of the points of `more` behind those of `cloud` (merge.hpp). */
PSK_C_API psk_code psk_cloud_merge(psk_cloud* cloud, const psk_cloud* more, psk_error* error);
/* Leaves the points where `keep` (shape (n)) is not 0; the others count as dropped. */
PSK_C_API psk_code psk_cloud_keep(psk_cloud* cloud, const uint8_t* keep, int64_t count, psk_error* error);

typedef struct psk_write_options {
  size_t size;
  int32_t ascii;              /* 1: PLY as text */
  int32_t threads;            /* 0: all */
  int32_t double_coordinates; /* 1: PLY with coordinates as double also where the origin is zero */
  int32_t compress;           /* 1: GLB with quantised values and meshoptimizer's coding */
} psk_write_options;

/* Writes a cloud; the format follows the extension (docs/formats.md). The file appears whole or not at all. */
PSK_C_API psk_code psk_cloud_write(const psk_cloud* cloud, const char* path, const psk_write_options* options,
                                   psk_error* error);

/* ---- Normals (normals.hpp) ----------------------------------------------------------------------------------- */

enum {
  PSK_NORMALS_AUTOMATIC = 0,
  PSK_NORMALS_SENSOR = 1,
  PSK_NORMALS_PROPAGATE = 2,
  PSK_NORMALS_ITERATE = 3,
  PSK_NORMALS_REPAIR = 4
};

typedef struct psk_normal_options {
  size_t size;
  const double* sensors; /* (sensor_count, 3), world coordinates */
  int64_t sensor_count;
  psk_progress progress;
  void* user;
  uint64_t seed;
  double time_limit_s, keep_within_degrees;
  int32_t method; /* PSK_NORMALS_... */
  int32_t random_start, max_rounds, confidence, curvature;
} psk_normal_options;

typedef struct psk_normal_report {
  size_t size;
  const char* assumed; /* what could not be known; valid until the cloud is changed or freed */
  const char* warning; /* NULL, or that most normals are a guess; as long */
  int64_t points, given, kept, flipped, replaced, doubtful, patches, components, turned;
  int64_t device_peak_bytes;
  double enclosing, estimate_ms, propagate_ms, iterate_ms, total_ms;
  int32_t method, rounds, settled;
} psk_normal_report;

/* Gives every point of `cloud` an outward unit normal. options and report may be NULL. */
PSK_C_API psk_code psk_orient(psk_workspace* workspace, psk_cloud* cloud, const psk_normal_options* options,
                              psk_normal_report* report, psk_error* error);

/* ---- Meshes -------------------------------------------------------------------------------------------------- */

/* A triangle mesh, on the host or in the memory of a workspace's device. See mesh.hpp and device_data.hpp. */
typedef struct psk_mesh psk_mesh;

/* Copies a mesh from the caller's memory, on the host. Fails with PSK_INVALID_INPUT for ids out of range. */
PSK_C_API psk_code psk_mesh_create(const psk_triangles* triangles, const psk_read_options* options, psk_mesh** mesh,
                                   psk_error* error);
PSK_C_API psk_code psk_mesh_read(const char* path, const psk_read_options* options, psk_mesh** mesh, psk_error* error);
/* Reads a mesh where the file has faces, else a cloud; the other one is set to NULL. */
PSK_C_API psk_code psk_read(const char* path, const psk_read_options* options, psk_cloud** cloud, psk_mesh** mesh,
                            psk_error* error);
PSK_C_API psk_code psk_mesh_write(const psk_mesh* mesh, const char* path, const psk_write_options* options,
                                  psk_error* error);
PSK_C_API psk_code psk_mesh_copy(const psk_mesh* mesh, psk_mesh** copy, psk_error* error);
PSK_C_API void psk_mesh_free(psk_mesh* mesh);

/* PSK_HOST or PSK_DEVICE. All functions below that take a mesh copy one on a device to the host first, but those that
   only look at its arrays. */
PSK_C_API int32_t psk_mesh_memory(const psk_mesh* mesh);
/* A copy on the host; of a mesh that is there already, too. Waits for the device. */
PSK_C_API psk_code psk_mesh_to_host(const psk_mesh* mesh, psk_mesh** copy, psk_error* error);

PSK_C_API int64_t psk_mesh_vertex_count(const psk_mesh* mesh);
PSK_C_API int64_t psk_mesh_triangle_count(const psk_mesh* mesh);
/* World position of vertex i = origin + vertices[i]. */
PSK_C_API void psk_mesh_origin(const psk_mesh* mesh, double origin[3]);
/* Views of the mesh's own memory, valid until it is changed or freed: (v, 3) float32; (v, 3) float32 or data NULL;
   (t, 3) int32. On a device they are ready in the order of its workspace's stream. */
PSK_C_API psk_array psk_mesh_vertices(const psk_mesh* mesh);
PSK_C_API psk_array psk_mesh_normals(const psk_mesh* mesh);
PSK_C_API psk_array psk_mesh_triangles(const psk_mesh* mesh);
PSK_C_API int64_t psk_mesh_attribute_count(const psk_mesh* mesh);
PSK_C_API psk_attribute psk_mesh_attribute(const psk_mesh* mesh, int64_t index);
/* The GPU that holds the mesh, -1 for the host, and the stream in whose order it is ready. */
PSK_C_API int32_t psk_mesh_gpu(const psk_mesh* mesh);
PSK_C_API void* psk_mesh_stream(const psk_mesh* mesh);

/* A cloud of the vertices, with normals and attributes. */
PSK_C_API psk_code psk_mesh_cloud(const psk_mesh* mesh, psk_cloud** cloud, psk_error* error);
/* Gives the vertices of a mesh on the host the area-weighted means of the normals around. */
PSK_C_API psk_code psk_mesh_add_normals(psk_mesh* mesh, psk_error* error);

/* See MeshReport, MeshComponents and SelfIntersections (mesh.hpp). */
typedef struct psk_mesh_report {
  size_t size;
  int64_t vertices, used_vertices, triangles, edges, boundary_edges, non_manifold_edges, misoriented_edges;
  int64_t non_manifold_vertices, degenerate_triangles, components, euler;
  double volume, area;
  int32_t closed, manifold, oriented, watertight;
} psk_mesh_report;

PSK_C_API psk_code psk_mesh_measure(const psk_mesh* mesh, int32_t threads, psk_mesh_report* report, psk_error* error);

/* See ScaleOptions (scale.hpp). */
typedef struct psk_scale_options {
  size_t size;
  int64_t max_memory_bytes; /* that the work may take, beside the process; 0: as much as it likes */
  int32_t threads;          /* 0: all */
} psk_scale_options;

/* The same numbers, to the last bit, as psk_mesh_measure() of the mesh in a file, which is read in parts where memory
   does not hold it. Fails with PSK_INVALID_INPUT as psk_mesh_read(), and with PSK_OVER_LIMIT where the limit is too
   small or the file cannot be read in parts (scale.hpp). O(t log t), and two readings of the triangles for each range of
   vertices that memory holds. */
PSK_C_API psk_code psk_measure_file(const char* path, const psk_scale_options* options, psk_mesh_report* report,
                                    psk_error* error);
/* Pairs of triangles that meet elsewhere than in what they share; `touching` of them only in points of their borders. */
PSK_C_API psk_code psk_mesh_self_intersections(const psk_mesh* mesh, int32_t threads, int64_t* pairs, int64_t* touching,
                                               psk_error* error);
/* The connected piece of every vertex, -1 where no triangle uses it. of_vertex: shape (v), or NULL. */
PSK_C_API psk_code psk_mesh_components(const psk_mesh* mesh, int32_t threads, int32_t* of_vertex, int64_t* count,
                                       psk_error* error);

/* ---- Reconstruction (reconstruct.hpp) ------------------------------------------------------------------------ */

enum {
  PSK_POINT_NORMALS_AUTOMATIC = 0,
  PSK_POINT_NORMALS_GIVEN = 1,
  PSK_POINT_NORMALS_REPAIR = 2,
  PSK_POINT_NORMALS_ESTIMATE = 3
};
enum { PSK_FIELD_POISSON = 0, PSK_FIELD_DISTANCE = 1 };
enum { PSK_BOUNDARY_FREE = 0, PSK_BOUNDARY_DIRICHLET = 1 };
enum { PSK_FACES_CLOSED = 0, PSK_FACES_OPEN = 1 };

#define PSK_AUTOMATIC_DEPTH 0
#define PSK_AUTOMATIC_TRIM (-1.0)

/* SolveOptions, ExtractOptions and RunOptions in one. */
typedef struct psk_options {
  size_t size;
  /* What is solved. */
  const psk_normal_options* normal_estimation; /* NULL: the defaults; its progress and confidence do not count */
  const psk_mesh* envelope;                    /* NULL: none */
  double screening, scale, samples_per_node, offset;
  int32_t depth; /* 1 to 20, or PSK_AUTOMATIC_DEPTH */
  int32_t point_normals, field, fixed_screening, iterations, confidence, boundary, keep_strays;
  /* What is extracted. */
  double isovalue, trim, island_ratio, min_component;
  int32_t has_isovalue; /* 0: the field's own, and `isovalue` does not count */
  int32_t normals, linear_fit, domain_faces, largest, density, weakness, attributes;
  /* How it runs. */
  psk_progress progress;
  void* user;
  int64_t max_memory_bytes;
  int32_t residuals;
} psk_options;

/* Never changes its layout. */
typedef struct psk_level_report {
  int64_t nodes, unknowns;
  double residual_before, residual_after;
  int32_t depth, iterations;
} psk_level_report;

/* Never changes its layout. kind: WarningKind (warning.hpp), by its name. */
typedef struct psk_warning {
  const char* kind;
  const char* text;
  double share;
} psk_warning;

/* See RunReport. Pointers are valid until the next run of the reconstructor. */
typedef struct psk_run_report {
  size_t size;
  const psk_warning* warnings;
  const psk_level_report* levels; /* depth 0 first */
  const char* normals_done;       /* "kept", "turned", "repaired" or "estimated" */
  int64_t warning_count, level_count, points, strays, nodes;
  double isovalue;
  double upload_ms, octree_ms, splat_ms, solve_ms, extract_ms, download_ms;
  int64_t device_peak_bytes;
  double trim_quantile, trim_density, trim_area_before, trim_area_removed;
  int64_t trim_triangles_before, trim_triangles_removed, trim_triangles_split, trim_islands_removed, trim_holes_filled;
  int64_t pieces, pieces_removed, pieces_triangles_removed;
  int64_t envelope_samples_outside, envelope_vertices_moved;
  double envelope_farthest_move, offset_cells, offset_cube_growth, offset_ms;
  int32_t depth;
} psk_run_report;

/* Fits fields to points and makes meshes of them, run after run, in a workspace. */
typedef struct psk_reconstructor psk_reconstructor;

PSK_C_API psk_code psk_reconstructor_create(psk_workspace* workspace, psk_reconstructor** reconstructor,
                                            psk_error* error);
PSK_C_API void psk_reconstructor_free(psk_reconstructor* reconstructor);

/* Points to mesh, on the host. options: NULL for the defaults. */
PSK_C_API psk_code psk_reconstruct(psk_reconstructor* reconstructor, const psk_cloud* cloud, const psk_options* options,
                                   psk_mesh** mesh, psk_error* error);

/* The same from arrays. memory: PSK_HOST, or PSK_DEVICE for a mesh where the workspace works. Packed float32 positions and normals and packed attributes
   in the memory of the workspace's device are used where they lie, without a copy, and must stay as they are until the
   stream has done the work; arrays of other types and strides are converted, and those on the host go to the device.
   What fills arrays on a device must be ordered before the call on the workspace's stream. On the host positions that
   are not finite are left out; on a device they are an error. */
PSK_C_API psk_code psk_reconstruct_points(psk_reconstructor* reconstructor, const psk_points* points,
                                          const psk_options* options, int32_t memory, psk_mesh** mesh,
                                          psk_error* error);

/* Report of the last run. */
PSK_C_API psk_code psk_reconstructor_report(const psk_reconstructor* reconstructor, psk_run_report* report,
                                            psk_error* error);

/* Bytes that psk_reconstruct() takes on its device, within 15 %. */
PSK_C_API psk_code psk_estimate_device_bytes(const psk_cloud* cloud, const psk_options* options, int32_t threads,
                                             int64_t* bytes, psk_error* error);

typedef struct psk_depth_suggestion {
  size_t size;
  double spacing, noise; /* world units */
  int32_t depth, supported;
} psk_depth_suggestion;

PSK_C_API psk_code psk_suggest_depth(psk_workspace* workspace, const psk_cloud* cloud, const psk_options* options,
                                     psk_depth_suggestion* suggestion, psk_error* error);

/* The implicit function (field.hpp), in its reconstructor's workspace, which it may outlive. */
typedef struct psk_field psk_field;

PSK_C_API psk_code psk_solve(psk_reconstructor* reconstructor, const psk_cloud* cloud, const psk_options* options,
                             psk_field** field, psk_error* error);
PSK_C_API psk_code psk_solve_points(psk_reconstructor* reconstructor, const psk_points* points,
                                    const psk_options* options, psk_field** field, psk_error* error);
PSK_C_API void psk_field_free(psk_field* field);
PSK_C_API double psk_field_isovalue(const psk_field* field);
/* The working cube, world units. */
PSK_C_API void psk_field_cube(const psk_field* field, double lower[3], double* side);
/* Values at points in world coordinates. points: shape (n, 3), PSK_HOST, any type; values: shape (n). */
PSK_C_API psk_code psk_field_values(const psk_field* field, const psk_array* points, float* values, psk_error* error);
/* memory: PSK_HOST or PSK_DEVICE (where the field's workspace works). */
PSK_C_API psk_code psk_field_extract(const psk_field* field, const psk_options* options, int32_t memory,
                                     psk_mesh** mesh, psk_error* error);

/* ---- Comparison (mesh.hpp) ----------------------------------------------------------------------------------- */

typedef struct psk_compare_options {
  size_t size;
  int64_t samples;
  double tau;
  int32_t threads;
} psk_compare_options;

/* mean, rms, p95, max; world units. */
typedef struct psk_comparison {
  size_t size;
  double reference_diagonal;
  int64_t samples, reference_samples;
  double to_reference[4], from_reference[4], two_sided[4];
  double normal_consistency, precision, recall, f_score;
  int32_t has_normals;
} psk_comparison;

/* Either a mesh or a cloud on each side; the other one is NULL. */
PSK_C_API psk_code psk_compare(const psk_mesh* mesh, const psk_cloud* cloud, const psk_mesh* reference_mesh,
                               const psk_cloud* reference_cloud, const psk_compare_options* options,
                               psk_comparison* comparison, psk_error* error);
/* Distance of every vertex or point from the reference, world units; distances: shape (v) or (n). with_sign: not 0 for
   negative ones inside of the reference, which must be a watertight mesh. */
PSK_C_API psk_code psk_distances(const psk_mesh* mesh, const psk_cloud* cloud, const psk_mesh* reference_mesh,
                                 const psk_cloud* reference_cloud, int32_t with_sign, int32_t threads,
                                 double* distances, psk_error* error);

/* ---- Pictures (render.hpp, camera.hpp) ----------------------------------------------------------------------- */

enum { PSK_UP_Y = 0, PSK_UP_Z = 1, PSK_UP_X = 2, PSK_UP_MINUS_X = 3, PSK_UP_MINUS_Y = 4, PSK_UP_MINUS_Z = 5 };

typedef struct psk_render_options {
  size_t size;
  const double* target;    /* (3) world, or NULL */
  const double* fit_world; /* (6) lower, upper, or NULL */
  const double* range;     /* (2) low, high, or NULL */
  const char* colour_by;   /* name of an attribute, "x", "y" or "z"; NULL: none */
  double azimuth_degrees, elevation_degrees, zoom;
  double field_of_view_degrees; /* 0: chosen */
  double point_size, point_size_world;
  int32_t width, height; /* pixels */
  int32_t up;            /* PSK_UP_... */
  int32_t orthographic, fit_sphere, smooth, back_faces, colours, shadows, wireframe;
  int32_t colour_map; /* 0 automatic, 1 sequential, 2 diverging */
  int32_t colour_bar, threads;
} psk_render_options;

typedef struct psk_render_report {
  size_t size;
  double covered, behind, low, high, point_size_world;
  int64_t strays;
  int32_t has_range;
} psk_render_report;

/* An sRGB picture. */
typedef struct psk_image psk_image;

/* Draws a mesh, or a cloud where the mesh is NULL. options and report may be NULL. */
PSK_C_API psk_code psk_render(const psk_mesh* mesh, const psk_cloud* cloud, const psk_render_options* options,
                              psk_image** image, psk_render_report* report, psk_error* error);
PSK_C_API void psk_image_free(psk_image* image);
/* Shape (height, width, 3), uint8, rows from top to bottom, as (height * width, 3); valid until the image is freed. */
PSK_C_API psk_array psk_image_pixels(const psk_image* image, int32_t* width, int32_t* height);
PSK_C_API psk_code psk_image_write_png(const psk_image* image, const char* path, psk_error* error);
/* The bytes of a PNG, valid until the image is changed or freed. */
PSK_C_API psk_code psk_image_png(psk_image* image, const uint8_t** bytes, int64_t* count, psk_error* error);

/* A view as OpenGL has it: matrices row by row, acting on columns; pixels from the upper left corner. Never changes its
   layout. */
typedef struct psk_camera {
  double view[16], projection[16];
  double width, height;
} psk_camera;

/* The camera of the picture that psk_render() draws. */
PSK_C_API psk_code psk_camera_of(const psk_mesh* mesh, const psk_cloud* cloud, const psk_render_options* options,
                                 psk_camera* camera, psk_error* error);

/* ---- Problems (problems.hpp) --------------------------------------------------------------------------------- */

typedef struct psk_problem_options {
  size_t size;
  double threshold, least_area;
  int32_t up, threads;
} psk_problem_options;

/* Never changes its layout. */
typedef struct psk_problem_view {
  double azimuth_degrees, elevation_degrees, target[3], matrix[16], zoom, visible;
} psk_problem_view;

typedef struct psk_problem {
  size_t size;
  double score, peak, area, centroid[3], lower[3], upper[3], mean_normal[3];
  int64_t triangles;
  psk_problem_view views[3];
  int32_t view_count;
} psk_problem;

typedef struct psk_problems psk_problems;

/* Regions of a mesh with the attribute "weakness" (psk_options::weakness), the worst first. */
PSK_C_API psk_code psk_find_problems(const psk_mesh* mesh, const psk_problem_options* options, psk_problems** problems,
                                     psk_error* error);
PSK_C_API int64_t psk_problems_count(const psk_problems* problems);
PSK_C_API psk_code psk_problems_get(const psk_problems* problems, int64_t index, psk_problem* problem,
                                    psk_error* error);
/* A picture of view number `view` of a problem. caption: NULL or lines of text. */
PSK_C_API psk_code psk_problems_render(const psk_problems* problems, int64_t index, int32_t view, const psk_mesh* mesh,
                                       const psk_render_options* options, const char* caption, psk_image** image,
                                       psk_error* error);
PSK_C_API void psk_problems_free(psk_problems* problems);

/* ---- Editing (edit.hpp) -------------------------------------------------------------------------------------- */

typedef struct psk_edit psk_edit;

typedef struct psk_edit_options {
  size_t size;
  const psk_options* reconstruction; /* NULL: the defaults */
  int64_t undo_bytes;
  int32_t topology, warm_start, continued, keep_attributes, states_kept;
} psk_edit_options;

enum { PSK_GUIDE = 0, PSK_REMOVE = 1, PSK_INSERT = 2, PSK_FLIP = 3 };

/* A closed polygon of the picture; together they are a region, even-odd. Never changes its layout. */
typedef struct psk_polygon {
  const double* pixels; /* (count, 2) */
  int64_t count;
} psk_polygon;

/* Guide, Remove, Insert or Flip; members that a kind does not have do not count. */
typedef struct psk_operation {
  size_t size;
  psk_camera camera;
  const psk_polygon* area;
  int64_t area_count;
  const double* stroke; /* (stroke_count, 2) pixels; a guide without one fills its area */
  int64_t stroke_count;
  const psk_cloud* part;                     /* of an insert; copied */
  double interval;                           /* of a guide, world units; 0: the width of the finest cells */
  double lower[3], upper[3];                 /* only points of the part in this box are inserted */
  double scale, rotation[9], translation[3]; /* from the part's world to that of the base cloud */
  int32_t kind;                              /* PSK_GUIDE ... */
  int32_t stroke_normals;                    /* 1: GuideNormals::stroke */
  int32_t inside_only, originals, front_layer, snap;
} psk_operation;

typedef struct psk_step_report {
  size_t size;
  int64_t added, removed, flipped, points, triangles;
  int64_t components_before, genus_before, euler_before, components_after, genus_after, euler_after;
  double edit_ms, reconstruct_ms, total_ms;
  int32_t snapped, warm;
} psk_step_report;

PSK_C_API psk_code psk_edit_create(psk_workspace* workspace, const psk_cloud* base, const psk_edit_options* options,
                                   psk_edit** edit, psk_error* error);
PSK_C_API void psk_edit_free(psk_edit* edit);
PSK_C_API psk_code psk_edit_apply(psk_edit* edit, const psk_operation* operation, psk_step_report* report,
                                  psk_error* error);
/* The points that psk_edit_apply() would add and remove. */
PSK_C_API psk_code psk_edit_preview(const psk_edit* edit, const psk_operation* operation, psk_cloud** added,
                                    psk_cloud** removed, psk_error* error);
/* *done: 0 if there was nothing to undo or redo. */
PSK_C_API psk_code psk_edit_undo(psk_edit* edit, int32_t* done, psk_error* error);
PSK_C_API psk_code psk_edit_redo(psk_edit* edit, int32_t* done, psk_error* error);
/* Copies of the present surface and points. */
PSK_C_API psk_code psk_edit_mesh(const psk_edit* edit, psk_mesh** mesh, psk_error* error);
PSK_C_API psk_code psk_edit_cloud(const psk_edit* edit, psk_cloud** cloud, psk_error* error);

/* ---- Deformation (deform.hpp) -------------------------------------------------------------------------------- */

enum { PSK_HALF_SPACE = 0, PSK_BALL = 1, PSK_AXIS_BOX = 2, PSK_CAPSULE = 3, PSK_POINT_SET = 4 };

/* A region and how it moves. */
typedef struct psk_handle {
  size_t size;
  const int64_t* points; /* of a point set: indices in the rest cloud */
  int64_t point_count;
  double a[3]; /* half-space: point; ball: centre; box: lower; capsule: from */
  double b[3]; /* half-space: normal; box: upper; capsule: to */
  double radius;
  double axis[3], axis_point[3], angle, translation[3]; /* a rigid motion, with affine 0; radians */
  double matrix[12], pivot[3];                          /* an affine map, with affine 1; (3, 4) row by row */
  int32_t region;                                       /* PSK_HALF_SPACE ... */
  int32_t affine;
} psk_handle;

typedef struct psk_lattice {
  size_t size;
  const double* control; /* ((l+1)(m+1)(n+1), 3), the last axis fastest; NULL: all at rest */
  double origin[3], axes[9];
  int32_t spans[3];
  int32_t stay; /* 1: points outside of the block stay */
} psk_lattice;

typedef struct psk_deform_report {
  size_t size;
  int64_t rest_points, points, inserted, thinned;
  double upload_ms, rest_ms, sample_ms, map_ms, mesh_ms;
} psk_deform_report;

typedef struct psk_deformer psk_deformer;

PSK_C_API psk_code psk_deformer_create(psk_workspace* workspace, const psk_cloud* rest, const psk_options* options,
                                       psk_deformer** deformer, psk_error* error);
PSK_C_API void psk_deformer_free(psk_deformer* deformer);
/* Moves the rest cloud. share: 1 for the whole deformation, 0 for none of it (scaled()). handles and lattices point to
   structs in a row, each as large as its first one says. */
PSK_C_API psk_code psk_deformer_deform(psk_deformer* deformer, const psk_handle* handles, int64_t handle_count,
                                       const psk_lattice* lattices, int64_t lattice_count, double share,
                                       psk_error* error);
PSK_C_API psk_code psk_deformer_mesh(psk_deformer* deformer, psk_mesh** mesh, psk_error* error);
PSK_C_API psk_code psk_deformer_cloud(const psk_deformer* deformer, psk_cloud** cloud, psk_error* error);
PSK_C_API psk_code psk_deformer_report(const psk_deformer* deformer, psk_deform_report* report, psk_error* error);

/* ---- Booleans (boolean.hpp) ---------------------------------------------------------------------------------- */

enum { PSK_UNITE = 0, PSK_INTERSECT = 1, PSK_SUBTRACT = 2, PSK_SYMMETRIC_DIFFERENCE = 3 };

typedef struct psk_boolean_options {
  size_t size;
  const psk_options* reconstruction; /* NULL: the defaults */
  double coincidence_cells;
  int32_t creases; /* 1: sampled, 0: none */
} psk_boolean_options;

typedef struct psk_boolean_report {
  size_t size;
  /* Of A and of B. */
  int64_t points[2], strays[2], kept[2], flipped[2], dropped[2], coincident[2];
  int64_t added, device_peak_bytes;
  double curve_length, classify_ms, crease_ms, gather_ms, apart_ms, total_ms;
} psk_boolean_report;

/* Either a mesh or a cloud for each of A and B; the other one is NULL. cloud may be NULL where only the mesh is wanted. */
PSK_C_API psk_code psk_boolean(psk_workspace* workspace, const psk_mesh* a_mesh, const psk_cloud* a_cloud,
                               const psk_mesh* b_mesh, const psk_cloud* b_cloud, int32_t operation,
                               const psk_boolean_options* options, psk_mesh** mesh, psk_cloud** cloud,
                               psk_boolean_report* report, psk_error* error);

/* ---- Fluids (fluid.hpp) -------------------------------------------------------------------------------------- */

enum { PSK_ISOTROPIC = 0, PSK_ANISOTROPIC = 1 };

typedef struct psk_fluid_options {
  size_t size;
  double particle_radius; /* world units; there is no default */
  double smoothing_length, cube_size, surface_threshold, min_component;
  int32_t kernel; /* PSK_ISOTROPIC ... */
  int32_t smoothing_iterations, smoothing_weights, normals, attributes;
} psk_fluid_options;

typedef struct psk_fluid_report {
  size_t size;
  int64_t particles, coarse_corners, fine_corners, removed_components, device_peak_bytes;
  double upload_ms, particles_ms, field_ms, extract_ms, finish_ms, download_ms;
  int32_t depth, rounds;
} psk_fluid_report;

/* Makes surfaces of frame after frame. */
typedef struct psk_fluid psk_fluid;

PSK_C_API psk_code psk_fluid_create(psk_workspace* workspace, psk_fluid** fluid, psk_error* error);
PSK_C_API void psk_fluid_free(psk_fluid* fluid);
PSK_C_API psk_code psk_fluid_surface(psk_fluid* fluid, const psk_cloud* particles, const psk_fluid_options* options,
                                     psk_mesh** mesh, psk_error* error);
/* As psk_reconstruct_points(). */
PSK_C_API psk_code psk_fluid_surface_points(psk_fluid* fluid, const psk_points* particles,
                                            const psk_fluid_options* options, int32_t memory, psk_mesh** mesh,
                                            psk_error* error);
PSK_C_API psk_code psk_fluid_get_report(const psk_fluid* fluid, psk_fluid_report* report, psk_error* error);

/* ---- File formats (formats.hpp) ------------------------------------------------------------------------------ */

/* Never changes its layout. Pointers are valid for ever. */
typedef struct psk_format {
  const char* name;
  const char* extensions; /* with their dots, separated by spaces */
  int32_t reads_clouds, reads_meshes, writes_clouds, writes_meshes;
} psk_format;

PSK_C_API int64_t psk_format_count(void);
PSK_C_API psk_format psk_format_get(int64_t index);

/* psk_init() of a struct that is a variable. Ignores failures, of which there are none for structs of this header. */
#define PSK_INIT_AS(kind, variable) ((void)psk_init((kind), &(variable), sizeof(variable), NULL))
#ifdef __cplusplus
}
#endif

#if defined(__STDC_VERSION__) && __STDC_VERSION__ >= 201112L
#define PSK_KIND_OF(variable)                               \
  _Generic((variable), psk_options                          \
           : PSK_STRUCT_OPTIONS, psk_normal_options         \
           : PSK_STRUCT_NORMAL_OPTIONS, psk_read_options    \
           : PSK_STRUCT_READ_OPTIONS, psk_write_options     \
           : PSK_STRUCT_WRITE_OPTIONS, psk_points           \
           : PSK_STRUCT_POINTS, psk_triangles               \
           : PSK_STRUCT_TRIANGLES, psk_run_report           \
           : PSK_STRUCT_RUN_REPORT, psk_normal_report       \
           : PSK_STRUCT_NORMAL_REPORT, psk_mesh_report      \
           : PSK_STRUCT_MESH_REPORT, psk_compare_options    \
           : PSK_STRUCT_COMPARE_OPTIONS, psk_comparison     \
           : PSK_STRUCT_COMPARISON, psk_render_options      \
           : PSK_STRUCT_RENDER_OPTIONS, psk_render_report   \
           : PSK_STRUCT_RENDER_REPORT, psk_problem_options  \
           : PSK_STRUCT_PROBLEM_OPTIONS, psk_problem        \
           : PSK_STRUCT_PROBLEM, psk_edit_options           \
           : PSK_STRUCT_EDIT_OPTIONS, psk_operation         \
           : PSK_STRUCT_OPERATION, psk_step_report          \
           : PSK_STRUCT_STEP_REPORT, psk_handle             \
           : PSK_STRUCT_HANDLE, psk_lattice                 \
           : PSK_STRUCT_LATTICE, psk_deform_report          \
           : PSK_STRUCT_DEFORM_REPORT, psk_boolean_options  \
           : PSK_STRUCT_BOOLEAN_OPTIONS, psk_boolean_report \
           : PSK_STRUCT_BOOLEAN_REPORT, psk_fluid_options   \
           : PSK_STRUCT_FLUID_OPTIONS, psk_fluid_report     \
           : PSK_STRUCT_FLUID_REPORT, psk_depth_suggestion  \
           : PSK_STRUCT_DEPTH_SUGGESTION, psk_scale_options \
           : PSK_STRUCT_SCALE_OPTIONS)
/* With C11 the struct's type says its kind; C99 names it: PSK_INIT_AS(PSK_STRUCT_OPTIONS, options). */
#define PSK_INIT(variable) PSK_INIT_AS(PSK_KIND_OF(variable), variable)
#endif

#endif
