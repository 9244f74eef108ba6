// GPL-2.0-or-later. Fuzz target models: MD3 models as this program reads them, and model files that assimp reads, in a
// copy of the process. Where assimp, which is not instrumented, dies by itself, that is no finding.
#include "common/files/vfs.h"
#include "common/platform/process_copy.h"
#include "q3map2/model/model_load.h"
#include "tests/fuzz/fuzz_target.h"

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>

#include <csignal>
#include <fcntl.h>
#include <pthread.h>
#include <unistd.h>

namespace q3::fuzz {
namespace {

void CheckModel(const Model &model) {
    for (const ModelMesh &mesh : model.meshes)
        for (const auto &triangle : mesh.triangles)
            for (const int corner : triangle)
                Require(corner >= 0 && std::size_t(corner) < mesh.verts.size(), "a triangle without vertices");
}

void ReadOwnMd3(std::span<const std::byte> file) {
    for (const int frame : {0, 1}) {
        Model model;
        if (Accepts([&] { model = ReadMd3(file, "models/x.md3", frame); }))
            CheckModel(model);
    }
}

// ---- Other models, by assimp ----

constexpr CopyLimits kAssimpLimits{.moreBytes = 1u << 30, .cpuSeconds = 60};

/// Without this program's code.
bool AssimpEndsWell(const std::filesystem::path &path) {
    ProcessCopy copy(kAssimpLimits, [&path](Channel &channel) {
        Assimp::Importer importer;
        importer.ReadFile(path.string(), aiProcess_GenNormals | aiProcess_GenUVCoords |
                                             aiProcess_JoinIdenticalVertices | aiProcess_Triangulate |
                                             aiProcess_SortByPType | aiProcess_FindDegenerates | aiProcess_FlipUVs |
                                             aiProcess_FlipWindingOrder | aiProcess_PreTransformVertices |
                                             aiProcess_SplitLargeMeshes);
        channel.Send({});
    });
    return copy.ToCopy().Receive().has_value();
}

/// Keeps an input with which assimp dies, where Q3FUZZ_ASSIMP names a folder.
void KeepForAssimp(std::span<const std::byte> file, std::string_view extension) {
    std::fputs("fuzz target: assimp died\n", stderr);
    if (const char *folder = getenv("Q3FUZZ_ASSIMP")) {
        const std::string_view text(reinterpret_cast<const char *>(file.data()), file.size());
        std::ofstream(fmt::format("{}/{:016x}.{}", folder, std::hash<std::string_view>()(text), extension),
                      std::ios::binary)
            .write(text.data(), std::streamsize(text.size()));
    }
}

void ReadByLibrary(std::span<const std::byte> file, std::string_view extension) {
    const ScratchFolder folder;
    const std::string name = fmt::format("models/x.{}", extension);
    const std::filesystem::path path = folder.Write(name, file);
    SilentLog log;
    VirtualFileSystem files(log);
    files.Mount(folder.Path(), "pk3");
    ModelLibrary library(&files);
    std::string problem;
    const Model *model = library.Get(name, 0, problem);
    Require(model != nullptr || !problem.empty(), "no model and no problem");
    if (model != nullptr)
        CheckModel(*model);
    if (problem.find("(assimp)") == problem.npos)
        return;
    if (AssimpEndsWell(path))
        Fail(fmt::format("this program fails with a model, but not assimp by itself: {}", problem));
    KeepForAssimp(file, extension);
}

/// Of the sanitizers, where there are any: libFuzzer keeps inputs by it.
extern "C" void __sanitizer_set_death_callback(void (*callback)()) __attribute__((weak));

/// In a copy of the process: what dies there is no finding.
void ForgetFuzzer() {
    if (__sanitizer_set_death_callback != nullptr)
        __sanitizer_set_death_callback(nullptr);
    std::signal(SIGALRM, SIG_DFL);
    if (getenv("Q3FUZZ_SHOW") == nullptr)
        dup2(open("/dev/null", O_WRONLY), 2);
}
const int kAtForkStatus = pthread_atfork(nullptr, nullptr, ForgetFuzzer);

} // namespace
} // namespace q3::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
    using namespace q3::fuzz;
    constexpr std::string_view kExtensions[] = {"md3", "ase", "obj",  "mdc", "md2",     "lwo", "3ds", "dae",
                                                "fbx", "glb", "gltf", "x",   "md5mesh", "iqm", "stl", "ply"};
    Input input(data, size);
    const std::size_t which = input.Choose(2 * std::size(kExtensions));
    // Half of the choices are our own reader, which is much faster.
    if (which >= std::size(kExtensions))
        ReadOwnMd3(input.Rest());
    else
        ReadByLibrary(input.Rest(), kExtensions[which]);
    return 0;
}
