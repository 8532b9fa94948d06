/* The classic scene by the tessellation stage of OpenGL 4.5: what Dolomite's `--metric classic` is compared
 * with. Same patches, levels, path and colours as plugins/tessellation/src/classic, drawn into a framebuffer
 * with depth and timed to glFinish.
 *
 *   classic HEIGHTS [--frames N] [--size WxH] [--whole] [--picture FILE.ppm]
 *
 * prints one JSON object: medians over the frames. --whole also tessellates patches outside of the frustum, as
 * the scene's definition has it; else the control shader gives them level 0. See README.md beside it.
 */
#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/gl.h>
#include <GL/glext.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#ifndef EGL_PLATFORM_SURFACELESS_MESA
#define EGL_PLATFORM_SURFACELESS_MESA 0x31DD
#endif

/* Mesa's software tessellator counts the vertices of a draw call in 16 bits (22.3: patches go missing or are
 * torn beyond): a call has 32 patches, at most 34 848 vertices. */
enum { SAMPLES = 1024, PATCHES = 64, PATH = 120, BATCH = 32 };

static const char *vertex_source =
    "#version 450\n"
    "layout(location = 0) in vec4 place;\n"
    "out vec4 corner;\n"
    "void main() { corner = place; }\n";

/* Corners of a patch: (x, height, z, -); the range of its heights in w of the first two. */
static const char *control_source =
    "#version 450\n"
    "layout(vertices = 4) out;\n"
    "in vec4 corner[];\n"
    "out vec3 point[];\n"
    "uniform vec3 eye;\n"
    "uniform vec4 planes[6];\n"
    "uniform bool whole;\n"
    "float level(vec3 a, vec3 b) {\n"
    "  vec3 middle = 0.5 * (a + b);\n"
    "  float away = distance(vec3(middle.x, 0.0, middle.z), eye);\n"
    "  float relief = clamp(abs(a.y - b.y) / 10.0, 0.0, 1.0);\n"
    "  return away > 400.0 ? 1.0 : mix(32.0, 1.0, 0.6 * away / 400.0 + 0.4 * (1.0 - relief));\n"
    "}\n"
    "void main() {\n"
    "  point[gl_InvocationID] = corner[gl_InvocationID].xyz;\n"
    "  if (gl_InvocationID != 0) return;\n"
    "  vec3 a = corner[0].xyz, b = corner[1].xyz, c = corner[2].xyz, d = corner[3].xyz;\n"
    "  vec3 low = vec3(a.x, corner[0].w, c.z), high = vec3(c.x, corner[1].w, a.z);\n"
    "  bool seen = true;\n"
    "  for (int k = 0; k < 6; k++) {\n"
    "    vec3 far = mix(low, high, greaterThanEqual(planes[k].xyz, vec3(0.0)));\n"
    "    seen = seen && dot(planes[k].xyz, far) + planes[k].w >= 0.0;\n"
    "  }\n"
    "  vec4 outer = vec4(level(d, a), level(a, b), level(b, c), level(c, d));\n"
    "  if (!seen && !whole) outer = vec4(0.0);\n"
    "  gl_TessLevelOuter[0] = outer.x; gl_TessLevelOuter[1] = outer.y;\n"
    "  gl_TessLevelOuter[2] = outer.z; gl_TessLevelOuter[3] = outer.w;\n"
    "  gl_TessLevelInner[0] = max(outer.y, outer.w); gl_TessLevelInner[1] = max(outer.x, outer.z);\n"
    "}\n";

static const char *evaluation_source =
    "#version 450\n"
    "layout(quads, equal_spacing, ccw) in;\n"
    "in vec3 point[];\n"
    "out vec3 normal;\n"
    "out vec2 shade;\n"
    "uniform mat4 clip;\n"
    "layout(std430, binding = 0) readonly buffer Heights { float heights[]; };\n"
    "void main() {\n"
    "  vec2 place = mix(point[0].xz, point[2].xz, gl_TessCoord.xy);\n"
    "  vec2 from = place + 511.5;\n"
    "  vec2 low = floor(from), t = from - low;\n"
    "  ivec2 column = (ivec2(int(low.x)) + ivec2(0, 1)) & 1023;\n"
    "  ivec2 row = ((ivec2(int(low.y)) + ivec2(0, 1)) & 1023) * 1024;\n"
    "  float a = 100.0 * heights[row.x + column.x], b = 100.0 * heights[row.x + column.y];\n"
    "  float c = 100.0 * heights[row.y + column.x], d = 100.0 * heights[row.y + column.y];\n"
    "  float height = mix(mix(a, b, t.x), mix(c, d, t.x), t.y);\n"
    "  normal = vec3(-mix(b - a, d - c, t.y), 1.0, -mix(c - a, d - b, t.x));\n"
    "  vec3 position = vec3(place.x, height, place.y);\n"
    "  vec3 light = normalize(vec3(300.0, 500.0, 200.0) - position);\n"
    "  shade = vec2(max(dot(light, normalize(normal)), 0.0), (height + 90.0) / 200.0);\n"
    "  gl_Position = clip * vec4(position, 1.0);\n"
    "}\n";

static const char *fragment_source =
    "#version 450\n"
    "in vec3 normal;\n"
    "in vec2 shade;\n"
    "out vec4 colour;\n"
    "void main() {\n"
    "  vec3 grass = mix(vec3(0.06, 0.16, 0.22), vec3(0.14, 0.30, 0.07), clamp(shade.y * 4.0, 0.0, 1.0));\n"
    "  vec3 rock = mix(grass, vec3(0.36, 0.28, 0.20), clamp(shade.y * 4.0 - 1.6, 0.0, 1.0));\n"
    "  vec3 snow = mix(rock, vec3(0.9), clamp(shade.y * 5.0 - 3.4, 0.0, 1.0));\n"
    "  colour = vec4(snow * (0.12 + 0.88 * shade.x), 1.0);\n"
    "}\n";

static void fail(const char *what, const char *why) {
    fprintf(stderr, "classic: %s: %s\n", what, why);
    exit(1);
}

static GLuint compile(GLenum kind, const char *source) {
    GLuint shader = glCreateShader(kind);
    glShaderSource(shader, 1, &source, NULL);
    glCompileShader(shader);
    GLint done = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &done);
    if (!done) {
        char log[4096];
        glGetShaderInfoLog(shader, sizeof log, NULL, log);
        fail("shader", log);
    }
    return shader;
}

static float sample(const float *heights, int column, int row) {
    return 100.0f * heights[(row & (SAMPLES - 1)) * SAMPLES + (column & (SAMPLES - 1))];
}

static float height_at(const float *heights, float x, float z) {
    float fx = x + 511.5f, fz = z + 511.5f;
    int i = (int)floorf(fx), j = (int)floorf(fz);
    float u = fx - (float)i, v = fz - (float)j;
    float near = sample(heights, i, j) * (1 - u) + sample(heights, i + 1, j) * u;
    float far = sample(heights, i, j + 1) * (1 - u) + sample(heights, i + 1, j + 1) * u;
    return near * (1 - v) + far * v;
}

/* Lowest and highest height of a patch: of its samples, and those around it. */
static void range_of(const float *heights, float x, float z, float *low, float *high) {
    int first_i = (int)floorf(x + 511.5f), first_j = (int)floorf(z + 511.5f);
    *low = INFINITY;
    *high = -INFINITY;
    for (int j = first_j; j <= first_j + 17; j++)
        for (int i = first_i; i <= first_i + 17; i++) {
            float here = sample(heights, i, j);
            *low = fminf(*low, here);
            *high = fmaxf(*high, here);
        }
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double now_ms(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

/* Column-major view-projection of frame k, and the six planes (inside is positive). */
static void camera(int k, float aspect, float clip[16], float eye[3], float planes[24]) {
    double a = 2.0 * M_PI * k / PATH;
    eye[0] = (float)(200.0 * cos(a));
    eye[1] = 70.0f;
    eye[2] = (float)(200.0 * sin(a));
    double f[3] = {-sin(a), -0.25, cos(a)};
    double length = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
    for (int i = 0; i < 3; i++) f[i] /= length;
    /* right = forward x up, up = right x forward */
    double r[3] = {-f[2], 0.0, f[0]};
    length = sqrt(r[0] * r[0] + r[2] * r[2]);
    r[0] /= length;
    r[2] /= length;
    double u[3] = {r[1] * f[2] - r[2] * f[1], r[2] * f[0] - r[0] * f[2], r[0] * f[1] - r[1] * f[0]};
    double scale = 1.0 / tan(M_PI / 6.0), near = 0.1, far = 10000.0;
    double rows[4][4];
    for (int i = 0; i < 3; i++) {
        rows[0][i] = r[i] * scale / aspect;
        rows[1][i] = u[i] * scale;
        rows[2][i] = f[i] * (far + near) / (far - near);
        rows[3][i] = f[i];
    }
    for (int j = 0; j < 4; j++) {
        rows[j][3] = 0.0;
        for (int i = 0; i < 3; i++) rows[j][3] -= rows[j][i] * eye[i];
    }
    rows[2][3] -= 2.0 * far * near / (far - near);
    for (int j = 0; j < 4; j++)
        for (int i = 0; i < 4; i++) clip[i * 4 + j] = (float)rows[j][i];
    for (int p = 0; p < 6; p++)
        for (int i = 0; i < 4; i++)
            planes[p * 4 + i] = (float)(rows[3][i] + (p % 2 ? -1.0 : 1.0) * rows[p / 2][i]);
}

int main(int count, char **arguments) {
    const char *path = NULL, *picture = NULL;
    int frames = PATH, width = 1280, height = 720, whole = 0;
    for (int k = 1; k < count; k++) {
        if (!strcmp(arguments[k], "--whole")) whole = 1;
        else if (!strcmp(arguments[k], "--frames") && k + 1 < count) frames = atoi(arguments[++k]);
        else if (!strcmp(arguments[k], "--picture") && k + 1 < count) picture = arguments[++k];
        else if (!strcmp(arguments[k], "--size") && k + 1 < count) {
            if (sscanf(arguments[++k], "%dx%d", &width, &height) != 2) fail("--size", "WIDTHxHEIGHT");
        } else if (arguments[k][0] != '-' && !path) path = arguments[k];
        else fail(arguments[k], "classic HEIGHTS [--frames N] [--size WxH] [--whole] [--picture FILE.ppm]");
    }
    if (!path) fail("HEIGHTS", "the 1024 x 1024 little-endian f32 heights of the scene are needed");
    if (frames < 1 || frames > 100000 || width < 1 || height < 1 || width > 8192 || height > 8192)
        fail("--frames, --size", "out of range");
    float *heights = malloc(sizeof(float) * SAMPLES * SAMPLES);
    FILE *file = fopen(path, "rb");
    if (!file || fread(heights, sizeof(float), SAMPLES * SAMPLES, file) != SAMPLES * SAMPLES)
        fail(path, "cannot be read as 1024 x 1024 f32");
    fclose(file);

    PFNEGLGETPLATFORMDISPLAYEXTPROC get_display =
        (PFNEGLGETPLATFORMDISPLAYEXTPROC)eglGetProcAddress("eglGetPlatformDisplayEXT");
    EGLDisplay display =
        get_display ? get_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL) : EGL_NO_DISPLAY;
    if (display == EGL_NO_DISPLAY || !eglInitialize(display, NULL, NULL) || !eglBindAPI(EGL_OPENGL_API))
        fail("EGL", "no surfaceless display");
    EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE, EGL_PBUFFER_BIT, EGL_NONE};
    EGLConfig config = NULL;
    EGLint configs = 0;
    eglChooseConfig(display, wanted, &config, 1, &configs);
    EGLint version[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 5,
                        EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    EGLContext context = eglCreateContext(display, configs ? config : NULL, EGL_NO_CONTEXT, version);
    if (!context || !eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context))
        fail("EGL", "no OpenGL 4.5 core context");

    GLuint program = glCreateProgram();
    glAttachShader(program, compile(GL_VERTEX_SHADER, vertex_source));
    glAttachShader(program, compile(GL_TESS_CONTROL_SHADER, control_source));
    glAttachShader(program, compile(GL_TESS_EVALUATION_SHADER, evaluation_source));
    glAttachShader(program, compile(GL_FRAGMENT_SHADER, fragment_source));
    glLinkProgram(program);
    GLint linked = 0;
    glGetProgramiv(program, GL_LINK_STATUS, &linked);
    if (!linked) {
        char log[4096];
        glGetProgramInfoLog(program, sizeof log, NULL, log);
        fail("program", log);
    }
    glUseProgram(program);

    /* u along x, v against z, so that counter-clockwise triangles are seen from above. */
    float *points = malloc(sizeof(float) * 16 * PATCHES * PATCHES);
    float step = 1024.0f / PATCHES;
    for (int row = 0; row < PATCHES; row++)
        for (int column = 0; column < PATCHES; column++) {
            float low, high, x = column * step - 512.0f, z = row * step - 512.0f;
            range_of(heights, x, z, &low, &high);
            float corners[4][2] = {{x, z + step}, {x + step, z + step}, {x + step, z}, {x, z}};
            float *to = points + 16 * (row * PATCHES + column);
            for (int k = 0; k < 4; k++) {
                to[4 * k] = corners[k][0];
                to[4 * k + 1] = height_at(heights, corners[k][0], corners[k][1]);
                to[4 * k + 2] = corners[k][1];
                to[4 * k + 3] = k == 0 ? low : high;
            }
        }
    GLuint buffers[2], array, targets[2], framebuffer, query;
    glGenVertexArrays(1, &array);
    glBindVertexArray(array);
    glGenBuffers(2, buffers);
    glBindBuffer(GL_ARRAY_BUFFER, buffers[0]);
    glBufferData(GL_ARRAY_BUFFER, sizeof(float) * 16 * PATCHES * PATCHES, points, GL_STATIC_DRAW);
    glEnableVertexAttribArray(0);
    glVertexAttribPointer(0, 4, GL_FLOAT, GL_FALSE, 16, NULL);
    glBindBuffer(GL_SHADER_STORAGE_BUFFER, buffers[1]);
    glBufferData(GL_SHADER_STORAGE_BUFFER, sizeof(float) * SAMPLES * SAMPLES, heights, GL_STATIC_DRAW);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffers[1]);
    glGenRenderbuffers(2, targets);
    glBindRenderbuffer(GL_RENDERBUFFER, targets[0]);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, width, height);
    glBindRenderbuffer(GL_RENDERBUFFER, targets[1]);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, width, height);
    glGenFramebuffers(1, &framebuffer);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, targets[0]);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, targets[1]);
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) fail("framebuffer", "incomplete");
    glViewport(0, 0, width, height);
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_CULL_FACE);
    glPatchParameteri(GL_PATCH_VERTICES, 4);
    glClearColor(0.45f, 0.65f, 0.9f, 1.0f);
    glUniform1i(glGetUniformLocation(program, "whole"), whole);
    GLint clip_at = glGetUniformLocation(program, "clip"), eye_at = glGetUniformLocation(program, "eye");
    GLint planes_at = glGetUniformLocation(program, "planes");
    glGenQueries(1, &query);

    double *times = malloc(sizeof(double) * frames), *triangles = malloc(sizeof(double) * frames);
    /* Once uncounted: drivers compile with the first draw. Then counted, then timed. */
    for (int pass = 0; pass < 3; pass++)
        for (int k = 0; k < (pass == 0 ? 1 : frames); k++) {
            float clip[16], eye[3], planes[24];
            camera(k, (float)width / (float)height, clip, eye, planes);
            double start = now_ms();
            glUniformMatrix4fv(clip_at, 1, GL_FALSE, clip);
            glUniform3fv(eye_at, 1, eye);
            glUniform4fv(planes_at, 6, planes);
            glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
            if (pass == 1) glBeginQuery(GL_PRIMITIVES_GENERATED, query);
            for (int first = 0; first < PATCHES * PATCHES; first += BATCH)
                glDrawArrays(GL_PATCHES, 4 * first, 4 * BATCH);
            if (pass == 1) {
                glEndQuery(GL_PRIMITIVES_GENERATED);
                GLuint64 made = 0;
                glGetQueryObjectui64v(query, GL_QUERY_RESULT, &made);
                triangles[k] = (double)made;
            }
            glFinish();
            times[k] = now_ms() - start;
            if (pass == 0 && picture) {
                unsigned char *pixels = malloc(3 * (size_t)width * height);
                glPixelStorei(GL_PACK_ALIGNMENT, 1);
                glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, pixels);
                FILE *to = fopen(picture, "wb");
                if (!to) fail(picture, "cannot be written");
                fprintf(to, "P6 %d %d 255\n", width, height);
                for (int y = height - 1; y >= 0; y--) fwrite(pixels + 3 * (size_t)width * y, 3, width, to);
                fclose(to);
                free(pixels);
            }
        }
    GLenum error = glGetError();
    if (error != GL_NO_ERROR) {
        fprintf(stderr, "classic: OpenGL error 0x%x\n", error);
        return 1;
    }
    double sum = 0.0;
    for (int k = 0; k < frames; k++) sum += triangles[k];
    qsort(times, frames, sizeof(double), by_size);
    printf("{\"renderer\": \"%s\", \"size\": [%d, %d], \"frames\": %d, \"whole\": %s, "
           "\"frame_ms\": {\"median\": %.3f, \"p99\": %.3f}, \"triangles_mean\": %.0f}\n",
           (const char *)glGetString(GL_RENDERER), width, height, frames, whole ? "true" : "false",
           times[frames / 2], times[(frames * 99) / 100], sum / frames);
    return 0;
}
