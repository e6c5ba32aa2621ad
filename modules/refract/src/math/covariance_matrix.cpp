// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#include "math/covariance_matrix.hpp"
#include "opencv2/core/hal/hal.hpp"

namespace cv { namespace refract {

namespace {

const double PRINTED = 1e-6;    // parts of a standard deviation that six printed digits leave
const double ROUNDING = 1e-12;  // of the largest variance: one that is below 0 by this is 0

//! What of a matrix must be a covariance: some of its rows and columns.
class Part
{
public:
    Part(const Mat_<double>& C, const std::vector<int>& rows, const String& name) : C_(C), rows_(rows), name_(name)
    {
        for (int row : rows_)
        {
            least_ = std::min(least_, C_(row, row));
            most_ = std::max(most_, C_(row, row));
        }
    }

    void check() const
    {
        checkNumbers();
        Mat_<double> correlation((int)rows_.size(), (int)rows_.size(), 0.);
        for (int i = 0; i < correlation.rows; i++)
            for (int j = 0; j < correlation.cols; j++)
                correlation(i, j) = correlationOf(rows_[i], rows_[j]);
        for (int i = 0; i < correlation.rows; i++)
            for (int j = 0; j < i; j++)
                if (std::abs(correlation(i, j) - correlation(j, i)) > 2*PRINTED)
                    CV_Error_(Error::StsBadArg, ("%s is not symmetric: it has %g in row %d, column %d, but %g in row %d, column %d",
                                                 name_.c_str(), C_(rows_[j], rows_[i]), rows_[j], rows_[i], C_(rows_[i], rows_[j]),
                                                 rows_[i], rows_[j]));
        checkDefinite(correlation);
    }

    //! Known exactly.
    bool isExact(int row) const { return !(C_(row, row) > std::max(-least_, 0.)); }

private:
    void checkNumbers() const
    {
        for (int row : rows_)
        {
            for (int column : rows_)
                if (!std::isfinite(C_(row, column)))
                    CV_Error_(Error::StsBadArg, ("%s has %g in row %d, column %d; it must be finite", name_.c_str(), C_(row, column), row,
                                                 column));
            if (C_(row, row) < -ROUNDING*most_)
                CV_Error_(Error::StsBadArg, ("%s has the variance %g in row %d, below 0 on its diagonal; it must not be negative",
                                             name_.c_str(), C_(row, row), row));
        }
    }

    //! Between quantities in units of their standard deviations; 0 beside those that are known exactly.
    double correlationOf(int row, int column) const
    {
        const double first = C_(row, row), second = C_(column, column), both = C_(row, column);
        if (!isExact(row) && !isExact(column))
            return both/(std::sqrt(first)*std::sqrt(second));
        const double rounding = PRINTED*std::sqrt(most_)*std::sqrt(std::max(0., std::max(first, second)));
        if (std::abs(both) > std::max(std::max(-least_, 0.), rounding))
            CV_Error_(Error::StsBadArg, ("%s has a covariance that is not 0 for a quantity with variance 0: %g in row %d, column %d",
                                         name_.c_str(), both, row, column));
        return 0;
    }

    void checkDefinite(const Mat_<double>& correlation) const
    {
        if (correlation.empty())
            return;
        Mat_<double> more = correlation + 2*PRINTED*correlation.rows*Mat::eye(correlation.size(), CV_64F), values;
        if (hal::Cholesky64f(more.ptr<double>(), more.step, more.rows, NULL, 0, 0))
            return;
        eigen(correlation, values);
        CV_Error_(Error::StsBadArg, ("%s is not positive semidefinite: its correlations have the eigenvalue %g", name_.c_str(),
                                     values(values.rows - 1)));
    }

    const Mat_<double>& C_;
    const std::vector<int>& rows_;
    const String& name_;
    double least_ = 0, most_ = 0;
};

} // namespace

void checkCovariance(const Mat& C, const String& name)
{
    std::vector<int> rows;
    for (int row = 0; row < C.rows; row++)
        rows.push_back(row);
    const Mat_<double> numbers = C;
    Part(numbers, rows, name).check();
}

Mat_<double> knownCovariance(const Mat& C, const String& name)
{
    const Mat_<double> numbers = C;
    std::vector<int> rows;
    Mat_<double> known(C.size(), 0.);
    for (int row = 0; row < C.rows; row++)
    {
        if (std::isnan(numbers(row, row)))
            known(row, row) = numbers(row, row);
        else
            rows.push_back(row);
    }
    const Part part(numbers, rows, name);
    part.check();
    for (int row : rows)
        for (int column : rows)
            if (!part.isExact(row) && !part.isExact(column))
                known(row, column) = 0.5*(numbers(row, column) + numbers(column, row));
    return known;
}

}} // namespace
