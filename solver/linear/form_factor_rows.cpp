#include "solver/linear/form_factor_rows.h"

#include <algorithm>

#include "pipeline/system/vector_code.h"
#include "solver/linear/parallel_rows.h"

namespace patchlight {

namespace {

/// Adds the values of `columns` in a table [elements][kWidth] to `sum` [kWidth]. Groups of eight are summed pairwise in
/// the table's precision, which is exact for equal values.
template <class Number, int kWidth>
VECTOR_CODE void add_unweighted(std::span<const std::int32_t> columns, const Number* table, double* sum) {
  const auto at = [&](std::size_t k) { return table + std::size_t(columns[k]) * kWidth; };
  double total[kWidth] = {};
  std::size_t k = 0;
  for (; k + 8 <= columns.size(); k += 8) {
    const Number *a = at(k), *b = at(k + 1), *c = at(k + 2), *d = at(k + 3);
    const Number *e = at(k + 4), *f = at(k + 5), *g = at(k + 6), *h = at(k + 7);
    for (int i = 0; i < kWidth; ++i)
      total[i] += double(((a[i] + b[i]) + (c[i] + d[i])) + ((e[i] + f[i]) + (g[i] + h[i])));
  }
  for (; k < columns.size(); ++k)
    for (int i = 0; i < kWidth; ++i) total[i] += double(at(k)[i]);
  for (int i = 0; i < kWidth; ++i) sum[i] += total[i];
}

/// Adds the values times their weights.
template <class Number, int kWidth>
VECTOR_CODE void add_weighted(std::span<const std::int32_t> columns, const float* weights, const Number* table,
                              double* sum) {
  for (std::size_t k = 0; k < columns.size(); ++k) {
    const Number* const values = table + std::size_t(columns[k]) * kWidth;
    for (int i = 0; i < kWidth; ++i) sum[i] += double(values[i]) * double(weights[k]);
  }
}

}  // namespace

FormFactorRows::FormFactorRows(const TransportRows& rows, int sky) : transport_(rows), sky_(sky) {
  if (rows.mirrored.empty()) return;
  mirrored_starts_.assign(rows.starts.size(), 0);
  for (const auto& m : rows.mirrored) ++mirrored_starts_[2 * m.row + m.sample_set + 1];
  for (std::size_t k = 1; k < mirrored_starts_.size(); ++k) mirrored_starts_[k] += mirrored_starts_[k - 1];
}

template <class Number, int kWidth>
void FormFactorRows::gather_packed(const RadiosityTable& radiosity, std::span<const Output> outputs) const {
  const Number* const table = radiosity.values<Number>();
  const auto sum_sample_set = [&](std::size_t k, double* sum) {
    const std::uint64_t begin = transport_.starts[k];
    const auto columns = std::span(transport_.columns).subspan(begin, transport_.starts[k + 1] - begin);
    std::fill(sum, sum + kWidth, 0.0);
    if (transport_.rays == 0) {
      add_weighted<Number, kWidth>(columns, transport_.weights.data() + begin, table, sum);
    } else {
      add_unweighted<Number, kWidth>(columns, table, sum);
      for (int c = 0; c < kWidth; ++c) sum[c] *= double(transport_.hit_weights[k]);
    }
    if (!transport_.sky_starts.empty()) {
      const std::uint64_t sky = transport_.sky_starts[k];
      double found[kWidth] = {};
      add_unweighted<Number, kWidth>(std::span(transport_.sky_columns).subspan(sky, transport_.sky_starts[k + 1] - sky),
                                     table, found);
      for (int c = 0; c < kWidth; ++c) sum[c] += found[c] * double(transport_.sky_weights[k]);
    }
    if (mirrored_starts_.empty()) return;
    for (std::uint64_t at = mirrored_starts_[k]; at < mirrored_starts_[k + 1]; ++at) {
      const auto& m = transport_.mirrored[at];
      for (std::size_t c = 0; c < 3 * outputs.size(); ++c)
        sum[c] += double(table[std::size_t(m.patch) * kWidth + c]) * double(m.weight[int(c % 3)]);
    }
  };
  for_each_row(std::size_t(transport_.rows()), [&](std::size_t i) {
    double first[kWidth], second[kWidth];
    sum_sample_set(2 * i, first);
    sum_sample_set(2 * i + 1, second);
    for (std::size_t f = 0; f < outputs.size(); ++f)
      for (int c = 0; c < 3; ++c) {
        const double a = first[3 * f + c], b = second[3 * f + c];
        (*outputs[f].irradiance)[i].c[c] = 0.5 * (a + b);
        if (outputs[f].deviation) (*outputs[f].deviation)[i].c[c] = 0.5 * (a - b);
      }
  });
}

template <class Number>
void FormFactorRows::gather_stored(const RadiosityTable& table, std::span<const Output> outputs) const {
  if (table.width() == 4)
    gather_packed<Number, 4>(table, outputs);
  else if (table.width() == 8)
    gather_packed<Number, 8>(table, outputs);
  else
    gather_packed<Number, 16>(table, outputs);
}

void FormFactorRows::gather(const RadiosityTable& table, std::span<const Output> outputs) const {
  if (table.precision() == Precision::single)
    gather_stored<float>(table, outputs);
  else
    gather_stored<double>(table, outputs);
}

void FormFactorRows::gather(std::span<const Field> fields, const Scattering* scattering, Precision precision) const {
  if (fields.empty()) return;
  const std::size_t count = fields[0].radiosity->size();
  RadiosityTable table(fields.size(), sky_ > 0 ? std::size_t(transport_.rows()) + std::size_t(sky_) : count, precision);
  for_each_row(count, [&](std::size_t i) {
    for (std::size_t f = 0; f < fields.size(); ++f) {
      const Spectrum& value = (*fields[f].radiosity)[i];
      table.set(f, i, scattering ? value * scattering->albedo[i] : value);
    }
  });
  if (scattering)
    for (const Scattering::Passage& p : scattering->passages)
      for (std::size_t f = 0; f < fields.size(); ++f) table.add(f, p.to, p.part * (*fields[f].radiosity)[p.from]);
  std::vector<Output> outputs;
  for (const Field& field : fields) outputs.push_back(field.output);
  gather(table, outputs);
}

void FormFactorRows::gather(const SpectrumField& radiosity, SpectrumField& irradiance) const {
  const Field field{&radiosity, {&irradiance}};
  gather({&field, 1}, nullptr, Precision::full);
}

void FormFactorRows::gather_mirrored(const SpectrumField& radiosity, SpectrumField& irradiance,
                                     SpectrumField& deviation) const {
  std::fill(irradiance.begin(), irradiance.end(), Spectrum());
  std::fill(deviation.begin(), deviation.end(), Spectrum());
  for (const auto& m : transport_.mirrored) {
    if (std::size_t(m.patch) >= radiosity.size()) continue;  // the environment, black here
    const Spectrum received = radiosity[m.patch] * Spectrum(m.weight) * Spectrum(0.5);
    irradiance[m.row] += received;
    m.sample_set == 0 ? deviation[m.row] += received : deviation[m.row] -= received;
  }
}

SpectrumField FormFactorRows::row_sums() const {
  SpectrumField sums(std::size_t(transport_.rows()));
  for (std::size_t k = 0; k + 1 < transport_.starts.size(); ++k) {
    const std::uint64_t begin = transport_.starts[k], end = transport_.starts[k + 1];
    double sum = 0;
    const auto columns = std::span(transport_.columns).subspan(begin, end - begin);
    const auto is_sky = [&](std::int32_t column) { return column >= transport_.rows(); };
    if (transport_.rays > 0)
      sum = double(std::int64_t(end - begin) - (sky_ > 0 ? std::count_if(columns.begin(), columns.end(), is_sky) : 0)) *
            double(transport_.hit_weights[k]);
    else
      for (std::uint64_t at = begin; at < end; ++at)
        if (sky_ == 0 || !is_sky(transport_.columns[at])) sum += double(transport_.weights[at]);
    sums[k / 2] += Spectrum(0.5 * sum);
  }
  for (const auto& m : transport_.mirrored)
    if (sky_ == 0 || m.patch < transport_.rows()) sums[m.row] += Spectrum(m.weight) * Spectrum(0.5);
  return sums;
}

void gather_lights(const LightRows& lights, const SpectrumField& emission, SpectrumField& irradiance,
                   SpectrumField* deviation) {
  for (std::size_t i = 0; 2 * i + 1 < lights.starts.size(); ++i) {
    std::array<Spectrum, 2> sums;
    for (std::size_t set = 0; set < 2; ++set)
      for (std::uint64_t at = lights.starts[2 * i + set]; at < lights.starts[2 * i + set + 1]; ++at)
        sums[set] += emission[lights.patches[at]] * Spectrum(double(lights.weights[at]));
    irradiance[i] += (sums[0] + sums[1]) * Spectrum(0.5);
    if (deviation) (*deviation)[i] += (sums[0] - sums[1]) * Spectrum(0.5);
  }
}

}  // namespace patchlight
