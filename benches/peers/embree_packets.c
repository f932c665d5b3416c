/* Embree's packets of 16 and 8 rays and its single rays, timed by the thread's own clock. Built and called by
 * ray_casting.py; Embree itself comes out of the embreex wheel, and its functions by name: no header is needed.
 * Layouts are those of Embree 4's rtcore_ray.h and rtcore_common.h. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { TRIANGLES = 0, INDEX = 0, VERTEX = 1, UINT3 = 0x5003, FLOAT3 = 0x9003, HIGH = 2, ROBUST = 1 << 2, COHERENT = 1 << 16 };

struct arguments {
    int flags;
    unsigned features;
    void *context, *filter, *intersect;
    float width[4];
};

/* RTCRayHit16; the other widths are the same with fewer lanes. Room is left for what versions add at the end. */
#define PACKET(N)                                                                                                    \
    struct packet##N {                                                                                               \
        float org[3][N], tnear[N], dir[3][N], time[N], tfar[N];                                                      \
        unsigned mask[N], id[N], flags[N];                                                                           \
        float normal[3][N], uv[2][N];                                                                                \
        unsigned primitive[N], geometry[N], instance[4][N];                                                          \
    } __attribute__((aligned(64)))
PACKET(16);
PACKET(8);

static void *library, *scene;

static void *named(const char *name) { return dlsym(library, name); }

/* 0 if all went well. The buffers must outlive the scene; vertices have a float to spare at their end. */
int embree_open(const char *path, const float *vertices, size_t vertex_count, const unsigned *triangles, size_t triangle_count, int robust)
{
    library = dlopen(path, RTLD_NOW | RTLD_GLOBAL);
    if (!library || !named("rtcIntersect16")) return 1;
    void *(*new_device)(const char *) = named("rtcNewDevice");
    void *(*new_scene)(void *) = named("rtcNewScene");
    void *(*new_geometry)(void *, int) = named("rtcNewGeometry");
    void (*set_buffer)(void *, int, unsigned, int, const void *, size_t, size_t, size_t) = named("rtcSetSharedGeometryBuffer");
    void (*commit_geometry)(void *) = named("rtcCommitGeometry");
    unsigned (*attach)(void *, void *) = named("rtcAttachGeometry");
    void (*quality)(void *, int) = named("rtcSetSceneBuildQuality");
    void (*flags)(void *, int) = named("rtcSetSceneFlags");
    void (*commit_scene)(void *) = named("rtcCommitScene");
    void *device = new_device("threads=1");
    if (!device) return 2;
    scene = new_scene(device);
    void *geometry = new_geometry(device, TRIANGLES);
    set_buffer(geometry, VERTEX, 0, FLOAT3, vertices, 0, 12, vertex_count);
    set_buffer(geometry, INDEX, 0, UINT3, triangles, 0, 12, triangle_count);
    commit_geometry(geometry);
    attach(scene, geometry);
    quality(scene, HIGH);
    flags(scene, robust ? ROBUST : 0);
    commit_scene(scene);
    return 0;
}

static double seconds(void)
{
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return now.tv_sec + 1e-9 * now.tv_nsec;
}

#define CAST(N)                                                                                                      \
    static double cast##N(const float *o, const float *d, float *range, size_t count, float reach, int coherent)     \
    {                                                                                                                \
        void (*intersect)(const int *, void *, struct packet##N *, struct arguments *) = named("rtcIntersect" #N);   \
        struct arguments arguments = {coherent ? COHERENT : 0, 0xffffffffu, 0, 0, 0, {0}};                           \
        int valid[N] __attribute__((aligned(64)));                                                                   \
        for (int j = 0; j < N; j++) valid[j] = -1;                                                                   \
        struct packet##N packet;                                                                                     \
        memset(&packet, 0, sizeof packet);                                                                           \
        double begun = seconds();                                                                                    \
        for (size_t i = 0; i + N <= count; i += N) {                                                                 \
            for (int k = 0; k < 3; k++) {                                                                            \
                memcpy(packet.org[k], o + k * count + i, 4 * N);                                                     \
                memcpy(packet.dir[k], d + k * count + i, 4 * N);                                                     \
            }                                                                                                        \
            for (int j = 0; j < N; j++) packet.tfar[j] = reach, packet.mask[j] = ~0u, packet.geometry[j] = ~0u;      \
            intersect(valid, scene, &packet, &arguments);                                                            \
            memcpy(range + i, packet.tfar, 4 * N);                                                                   \
        }                                                                                                            \
        return seconds() - begun;                                                                                    \
    }
CAST(16)
CAST(8)

/* Single rays have no valid mask, and their packet is laid out ray by ray. */
static double cast1(const float *o, const float *d, float *range, size_t count, float reach, int coherent)
{
    struct {
        float org[3], tnear, dir[3], time, tfar;
        unsigned mask, id, flags;
        float normal[3], uv[2];
        unsigned primitive, geometry, instance[4];
    } __attribute__((aligned(16))) ray;
    void (*intersect)(void *, void *, struct arguments *) = named("rtcIntersect1");
    struct arguments arguments = {coherent ? COHERENT : 0, 0xffffffffu, 0, 0, 0, {0}};
    memset(&ray, 0, sizeof ray);
    double begun = seconds();
    for (size_t i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) ray.org[k] = o[k * count + i], ray.dir[k] = d[k * count + i];
        ray.tfar = reach, ray.mask = ~0u, ray.geometry = ~0u;
        intersect(scene, &ray, &arguments);
        range[i] = ray.tfar;
    }
    return seconds() - begun;
}

/* Casts rays, component by component, and gives the seconds that it took; the ranges of misses are `reach`. */
double embree_cast(int width, int coherent, const float *o, const float *d, float *range, size_t count, float reach)
{
    if (width == 16) return cast16(o, d, range, count, reach, coherent);
    if (width == 8) return cast8(o, d, range, count, reach, coherent);
    return cast1(o, d, range, count, reach, coherent);
}
