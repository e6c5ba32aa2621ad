#ifndef REFRACT_BENCH_GROWTH_HPP
#define REFRACT_BENCH_GROWTH_HPP

namespace bench {

//! Tables of time against points, layers, incidence and views, one thread.
void printGrowth();

} // namespace bench

#endif // REFRACT_BENCH_GROWTH_HPP
