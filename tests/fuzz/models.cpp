// GPL-2.0-or-later. Fuzz target models: MD3 models as this program reads them, and model files that assimp reads. Those
// are read in a process of their own, since assimp is neither instrumented nor safe; where assimp dies without this
// program, that is counted apart and no finding.
#include "common/files/vfs.h"
#include "q3map2/model/model_load.h"
#include "tests/fuzz/fuzz_target.h"

#include <assimp/Importer.hpp>
#include <assimp/postprocess.h>

#include <csignal>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
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

// ---- Processes for assimp ----

constexpr rlim_t kMoreMemory = 1024u << 20; ///< bytes of address space beyond what the process has
constexpr rlim_t kMostSeconds = 2;          ///< of computing: less than the time limit of an input
constexpr int kDoneStatus = 0;

/// Of the sanitizers, where there are any: libFuzzer keeps inputs by it.
extern "C" void __sanitizer_set_death_callback(void (*callback)()) __attribute__((weak));

/// Limits of this process from here on.
void Limit() {
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    const rlim_t space = rlim_t(pages) * rlim_t(sysconf(_SC_PAGESIZE)) + kMoreMemory;
    const rlimit memory{space, space}, time{kMostSeconds, kMostSeconds}, noCore{0, 0};
    setrlimit(RLIMIT_AS, &memory);
    setrlimit(RLIMIT_CPU, &time);
    setrlimit(RLIMIT_CORE, &noCore);
}

/// Whether `run` comes to its end in a process of its own.
template <typename Run> bool EndsWell(const Run &run) {
    const pid_t child = fork();
    if (child < 0)
        Fail("no process");
    if (child == 0) {
        for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGALRM, SIGXCPU})
            std::signal(signal, SIG_DFL);
        if (__sanitizer_set_death_callback != nullptr)
            __sanitizer_set_death_callback(nullptr);
        if (getenv("Q3FUZZ_SHOW") == nullptr)
            dup2(open("/dev/null", O_WRONLY), 2);
        Limit();
        run();
        _exit(kDoneStatus);
    }
    int status = 0;
    while (waitpid(child, &status, 0) < 0) {
    }
    return WIFEXITED(status) && WEXITSTATUS(status) == kDoneStatus;
}

/// Without this program's code.
void ReadByAssimpAlone(const std::filesystem::path &path) {
    Assimp::Importer importer;
    importer.ReadFile(path.string(), aiProcess_GenNormals | aiProcess_GenUVCoords | aiProcess_JoinIdenticalVertices |
                                         aiProcess_Triangulate | aiProcess_SortByPType | aiProcess_FindDegenerates |
                                         aiProcess_FlipUVs | aiProcess_FlipWindingOrder |
                                         aiProcess_PreTransformVertices | aiProcess_SplitLargeMeshes);
}

/// Keeps an input with which assimp dies, where Q3FUZZ_ASSIMP names a folder.
void KeepForAssimp(std::span<const std::byte> file, std::string_view extension) {
    std::fputs("fuzz target: assimp died\n", stderr);
    if (const char *folder = getenv("Q3FUZZ_ASSIMP")) {
        const std::size_t hash =
            std::hash<std::string_view>()({reinterpret_cast<const char *>(file.data()), file.size()});
        std::ofstream(fmt::format("{}/{:016x}.{}", folder, hash, extension), std::ios::binary)
            .write(reinterpret_cast<const char *>(file.data()), std::streamsize(file.size()));
    }
}

void ReadByLibrary(std::span<const std::byte> file, std::string_view extension) {
    const ScratchFolder folder;
    const std::string name = fmt::format("models/x.{}", extension);
    const std::filesystem::path path = folder.Write(name, file);
    const bool isGood = EndsWell([&] {
        SilentLog log;
        VirtualFileSystem files(log);
        files.Mount(folder.Path(), "pk3");
        ModelLibrary library(&files);
        std::string problem;
        const Model *model = library.Get(name, 0, problem);
        Require(model != nullptr || !problem.empty(), "no model and no problem");
        if (model != nullptr)
            CheckModel(*model);
    });
    if (isGood)
        return;
    if (EndsWell([&] { ReadByAssimpAlone(path); }))
        Fail("a model file with which this program dies, but not assimp by itself");
    KeepForAssimp(file, extension);
}

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
