// EGL headless: EGL devices (GPUs) first, then Mesa's surfaceless platform.

#include "server/draw/gl_context.hpp"

#include <epoxy/egl.h>
#include <epoxy/gl.h>

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
    std::string renderer() const override {
        return fmt::format("{}, OpenGL {}", reinterpret_cast<const char*>(glGetString(GL_RENDERER)),
                           reinterpret_cast<const char*>(glGetString(GL_VERSION)));
    }

  private:
    EGLDisplay display_;
    EGLContext context_;
};

// Displays to try, best first.
std::vector<EGLDisplay> headlessDisplays() {
    std::vector<EGLDisplay> displays;
    if (epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") &&
        epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device")) {
        EGLDeviceEXT devices[16];
        EGLint count = 0;
        eglQueryDevicesEXT(16, devices, &count);
        for (EGLint i = 0; i < count; ++i)
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

Result<std::unique_ptr<GlContext>> GlContext::createHeadless() {
    for (const EGLDisplay display : headlessDisplays()) {
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
