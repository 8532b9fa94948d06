/* Compiled and run by .ci/empty-root where nothing but our packages is installed: links what the build
 * scripts link, opens what the window opens, and asks the Vulkan loader for its devices. Exit code 0 when
 * each answers; no headers of X11 or Vulkan, since the game needs none. */
#include <alsa/asoundlib.h>
#include <dlfcn.h>
#include <libudev.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <wayland-client-core.h>

static int failures;

static void report(const char *name, int good, const char *what) {
    printf("  %-24s %s%s\n", name, good ? "ok, " : "FAILED, ", what);
    failures += !good;
}

/* A library of that name that has that function; null where not. */
static void *function(const char *library, const char *name) {
    void *handle = dlopen(library, RTLD_NOW | RTLD_LOCAL);
    void *found = handle ? dlsym(handle, name) : NULL;
    if (!found) report(library, 0, dlerror());
    return found;
}

static void opened(const char *library, const char *name) {
    if (function(library, name)) report(library, 1, name);
}

/* Keyboards come from files of another package (xkb-data), which ours have to bring. */
static void keyboard(void) {
    void *(*context_new)(int) = function("libxkbcommon.so.0", "xkb_context_new");
    void *(*keymap_new)(void *, const void *, int) = function("libxkbcommon.so.0", "xkb_keymap_new_from_names");
    if (!context_new || !keymap_new) return;
    void *context = context_new(0);
    report("libxkbcommon.so.0", context && keymap_new(context, NULL, 0), "the default keyboard");
}

/* The layouts of Vulkan 1.0's structures; only what is read or written has a name. */
struct application { uint32_t type; const void *next; const char *name; uint32_t version; const char *engine;
                     uint32_t engine_version, api_version; };
struct create { uint32_t type; const void *next; uint32_t flags; const struct application *application;
                uint32_t layers; const char *const *layer_names; uint32_t extensions;
                const char *const *extension_names; };
struct properties { uint32_t api, driver, vendor, device, type; char name[256]; char rest[2048]; };

static void vulkan(void) {
    static const char *library = "libvulkan.so.1";
    int (*create_instance)(const struct create *, const void *, void **) = function(library, "vkCreateInstance");
    int (*devices)(void *, uint32_t *, void **) = function(library, "vkEnumeratePhysicalDevices");
    void (*describe)(void *, struct properties *) = function(library, "vkGetPhysicalDeviceProperties");
    if (!create_instance || !devices || !describe) return;
    /* The extensions that a window asks for. */
    const char *extensions[] = {"VK_KHR_surface", "VK_KHR_xlib_surface", "VK_KHR_xcb_surface",
                                "VK_KHR_wayland_surface"};
    struct application application = {0, NULL, "libraries", 0, NULL, 0, (1u << 22) | (1u << 12)};
    struct create create = {1, NULL, 0, &application, 0, NULL, 4, extensions};
    void *instance = NULL, *found[8];
    int result = create_instance(&create, NULL, &instance);
    if (result != 0) {
        printf("  vkCreateInstance returned %d\n", result);
        report(library, 0, "no instance with a window's extensions");
        return;
    }
    uint32_t count = 8;
    result = devices(instance, &count, found);
    int software = 0;
    for (uint32_t i = 0; result >= 0 && i < count; i++) {
        struct properties properties;
        describe(found[i], &properties);
        report("Vulkan device", 1, properties.name);
        software |= strstr(properties.name, "llvmpipe") != NULL;
    }
    report(library, software, "a software device is among them");
}

int main(void) {
    struct udev *udev = udev_new();
    report("libudev", udev && udev_enumerate_new(udev), "linked");
    /* No display is there; that the library answers is what is asked. */
    report("libwayland-client", wl_display_connect("no-such-display") == NULL, "linked");
    report("libasound", strlen(snd_asoundlib_version()) > 0, "linked");
    opened("libwayland-client.so.0", "wl_display_connect");
    opened("libX11.so.6", "XOpenDisplay");
    opened("libX11-xcb.so.1", "XGetXCBConnection");
    opened("libxcb.so.1", "xcb_connect");
    opened("libXcursor.so.1", "XcursorLibraryLoadCursor");
    opened("libXi.so.6", "XIQueryVersion");
    opened("libxkbcommon-x11.so.0", "xkb_x11_keymap_new_from_device");
    keyboard();
    vulkan();
    return failures != 0;
}
