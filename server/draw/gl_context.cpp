// EGL headless: EGL devices (GPUs) first, then Mesa's surfaceless platform.

#include "server/draw/gl_context.hpp"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <string_view>
#include <vector>

namespace iwalk {
namespace {

class EglContext : public GlContext {
  public:
    EglContext(EGLDisplay display, EGLContext context) : display_(display), context_(context) {}
    ~EglContext() override {
        eglMakeCurrent(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        eglDestroyContext(display_, context_);
        eglTerminate(display_);
    }

  private:
    EGLDisplay display_;
    EGLContext context_;
};

// A device that cannot be asked is taken for one.
bool isGpu(EGLDeviceEXT device) {
    if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_query")) return true;
    const char* extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
    return !extensions ||
           std::string_view(extensions).find("EGL_MESA_device_software") == std::string_view::npos;
}

// Displays to try, best first.
std::vector<EGLDisplay> headlessDisplays(std::size_t localRank) {
    std::vector<EGLDisplay> displays;
    if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") &&
        epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device")) {
        EGLDeviceEXT devices[16];
        EGLint count = 0;
        eglQueryDevicesEXT(16, devices, &count);
        std::vector<bool> gpus;
        for (EGLint i = 0; i < count; ++i) gpus.push_back(isGpu(devices[i]));
        for (const std::size_t i : deviceOrder(gpus, localRank))
            displays.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr));
    }
    if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
        displays.push_back(
            eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
    return displays;
}

EGLContext createContext(EGLDisplay display) {
    const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                 4,
                                 EGL_CONTEXT_MINOR_VERSION,
                                 5,
                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                 EGL_NONE};
    if (!eglBindAPI(EGL_OPENGL_API)) return EGL_NO_CONTEXT;
    return eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes);
}

}  // namespace

std::string GlContext::renderer() const {
    return fmt::format("{}, OpenGL {}", reinterpret_cast<const char*>(glGetString(GL_RENDERER)),
                       reinterpret_cast<const char*>(glGetString(GL_VERSION)));
}

std::vector<std::size_t> deviceOrder(const std::vector<bool>& gpus, std::size_t localRank) {
    std::vector<std::size_t> order, others;
    for (std::size_t i = 0; i < gpus.size(); ++i) (gpus[i] ? order : others).push_back(i);
    if (!order.empty())
        std::rotate(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(localRank % order.size()),
                    order.end());
    order.insert(order.end(), others.begin(), others.end());
    return order;
}

Result<std::unique_ptr<GlContext>> GlContext::createHeadless(std::size_t localRank) {
    for (const EGLDisplay display : headlessDisplays(localRank)) {
        if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) continue;
        const EGLContext context = createContext(display);
        if (context != EGL_NO_CONTEXT && eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context))
            return std::unique_ptr<GlContext>(std::make_unique<EglContext>(display, context));
        eglTerminate(display);
    }
    return fail(
        "no headless OpenGL 4.5 to be had through EGL: install a driver (Debian: libgl1-mesa-dri libegl1)");
}

}  // namespace iwalk
