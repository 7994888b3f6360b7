// OpenVDB's LevelSetMorphing on the pair of benchmarks/morph.py: ball to ring, frames at equal s = 1 - exp(-t).
//
// Its speed is the target's distance cut at the target's narrow band, so the ring gets a band as wide as the farthest
// place of the ball: then the speed is d_B all the way, as in geofit. Prints CPU seconds of the frames, all included:
// both level sets, the evolution to s = 1 - 1/e^4, and the triangles of every frame.
//
// g++ -O3 -std=c++17 openvdb_morph.cpp -lopenvdb -ltbb     (Debian: libopenvdb-dev)

#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetMorph.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tools/VolumeToMesh.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

using openvdb::FloatGrid;

namespace {

double cpu() { return double(std::clock()) / CLOCKS_PER_SEC; }

FloatGrid::Ptr ring(double radius, double tube, double h, double wide)
{
    auto grid = FloatGrid::create(float(wide));
    grid->setTransform(openvdb::math::Transform::createLinearTransform(h));
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    auto access = grid->getAccessor();
    const int flat = int(std::ceil((radius + tube + wide) / h)), high = int(std::ceil((tube + wide) / h));
    for (int i = -flat; i <= flat; ++i)
        for (int j = -flat; j <= flat; ++j)
            for (int k = -high; k <= high; ++k) {
                const double d = std::hypot(std::hypot(i * h, j * h) - radius, k * h) - tube;
                if (std::abs(d) < wide) access.setValue({i, j, k}, float(d));
                else if (d < 0) access.setValueOff({i, j, k}, float(-wide));
            }
    return grid;
}

} // namespace

int main(int argc, char** argv)
{
    const int cells = argc > 1 ? std::atoi(argv[1]) : 128, frames = argc > 2 ? std::atoi(argv[2]) : 50;
    const bool fifth = argc > 3 && std::atoi(argv[3]) == 5;
    openvdb::initialize();
    const double h = 2 * (0.55 + 0.22) / cells, end = 4.0;
    const double start = cpu();
    auto front = openvdb::tools::createLevelSetSphere<FloatGrid>(0.5f, openvdb::Vec3f(0), float(h), 3.0f);
    const auto target = ring(0.55, 0.22, h, 0.5);
    const double made = cpu();
    openvdb::tools::LevelSetMorphing<FloatGrid> morph(*front, *target);
    morph.setSpatialScheme(fifth ? openvdb::math::HJWENO5_BIAS : openvdb::math::FIRST_BIAS);
    morph.setTemporalScheme(fifth ? openvdb::math::TVD_RK2 : openvdb::math::TVD_RK1);
    morph.setTrackerSpatialScheme(fifth ? openvdb::math::HJWENO5_BIAS : openvdb::math::FIRST_BIAS);
    morph.setTrackerTemporalScheme(fifth ? openvdb::math::TVD_RK2 : openvdb::math::TVD_RK1);
    double before = 0, meshing = 0;
    std::size_t steps = 0, triangles = 0;
    for (int k = 0; k < frames; ++k) {
        const double s = (1 - std::exp(-end)) * k / (frames - 1), t = -std::log(1 - s);
        if (t > before) steps += morph.advect(float(before), float(t));
        before = t;
        std::vector<openvdb::Vec3s> points;
        std::vector<openvdb::Vec3I> faces;
        std::vector<openvdb::Vec4I> quads;
        const double now = cpu();
        openvdb::tools::volumeToMesh(*front, points, faces, quads, 0.0, 0.0);
        meshing += cpu() - now;
        triangles += faces.size() + 2 * quads.size();
    }
    const double whole = cpu() - start;
    std::printf("{\"seconds\": %.3f, \"level_sets\": %.3f, \"triangles_of_frames\": %.3f, \"steps\": %zu, \"triangles\": %zu}\n",
        whole, made - start, meshing, steps, triangles);
    return 0;
}
