// Two atoms, block by block, without any file: counts inside points and sums the area by itself,
// and holds both against the run's own sums.

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <eses/error.hpp>
#include <eses/run.hpp>
#include <vector>

int main() {
  const std::vector<eses::Atom> atoms{{{0, 0, 0}, 1.7}, {{2.5, 0.3, 0}, 1.5}};
  const eses::Molecule molecule(atoms);
  eses::Parameters parameters;
  parameters.spacing = 0.2;
  parameters.block_size = 9;
  const eses::Plan plan = eses::make_plan(molecule, parameters, eses::OutputChoice::none());

  std::int64_t inside = 0;
  double area = 0;
  eses::Callbacks callbacks;
  callbacks.block = [&](const eses::SolvedBlock& solved) {
    const eses::Block& block = solved.block();
    for (std::int64_t z = block.first[2]; z < block.first[2] + block.owned[2]; ++z)
      for (std::int64_t y = block.first[1]; y < block.first[1] + block.owned[1]; ++y) {
        for (std::int64_t x = block.first[0]; x < block.first[0] + block.owned[0]; ++x)
          inside += solved.is_inside({x, y, z});
        for (const eses::Crossing& crossing : solved.crossings_of_row(y, z))
          area +=
              std::fabs(crossing.normal[crossing.axis]) * parameters.spacing * parameters.spacing;
      }
  };
  const eses::Summary summary = eses::compute(molecule, plan, callbacks);

  std::printf("%lld points inside, area %.6f\n", static_cast<long long>(inside), area);
  const double sum = summary.atom_areas[0] + summary.atom_areas[1];
  const bool agrees = inside == summary.inside_points && std::fabs(area - summary.area) < 1e-6 &&
                      std::fabs(sum - summary.area) < 1e-9;
  try {
    parameters.spacing = -1;
    eses::make_plan(molecule, parameters, {});
  } catch (const eses::Error&) {
    return agrees ? 0 : 1;
  }
  return 1;
}
