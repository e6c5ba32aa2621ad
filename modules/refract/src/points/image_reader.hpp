// This file is part of OpenCV project.
// It is subject to the license terms in the LICENSE file found in the top-level directory
// of this distribution and at http://opencv.org/license.html.

#ifndef OPENCV_REFRACT_IMAGE_READER_HPP
#define OPENCV_REFRACT_IMAGE_READER_HPP

#include "points/pixel_block.hpp"
#include "arrays/views.hpp"

namespace cv { namespace refract {

//! All images of the points, block by block.
class ImageReader
{
public:
    void add(InputArray points, const String& name)
    {
        images_.push_back(PointReader(points, 2, name.c_str()));
        names_.push_back(name);
        if (images_.back().size() != size())
            CV_Error_(Error::StsUnmatchedSizes, ("%s has %d points, %s %d; they must agree", names_[0].c_str(), size(),
                                                 name.c_str(), images_.back().size()));
    }
    int size() const { return images_[0].size(); }
    int depth() const
    {
        int deepest = 0;
        for (const PointReader& image : images_)
            deepest = std::max(deepest, image.depth());
        return deepest;
    }
    int cameras() const { return (int)images_.size(); }

    //! A pixel that is not finite is the point's status.
    void load(int begin, int n, PixelBlock& block) const
    {
        uchar own[BLOCK];
        for (int c = 0; c < cameras(); c++)
        {
            uchar* status = c ? own : block.status;
            images_[c].load(begin, n, block.pixel(2*c), block.pixel(2*c + 1), NULL, status);
            for (int i = 0; i < n && c > 0; i++)
                if (block.status[i] == REFRACT_OK)
                    block.status[i] = own[i];
        }
    }

    //! NaN coordinates were not seen. @param takesHalves pixels of which one coordinate was
    void loadSeen(int begin, int n, bool takesHalves, PixelBlock& block) const
    {
        uchar own[BLOCK];
        int coordinates[BLOCK] = {};
        std::fill(block.status, block.status + n, (uchar)REFRACT_OK);
        for (int c = 0; c < cameras(); c++)
        {
            double *u = block.pixel(2*c), *v = block.pixel(2*c + 1);
            images_[c].load(begin, n, u, v, NULL, own);
            int seen = 0;
            for (int i = 0; i < n; i++)
            {
                if (own[i] != REFRACT_OK && (std::isnan(u[i]) || std::isnan(v[i])))
                {
                    const bool isHalf = takesHalves && (std::isfinite(u[i]) || std::isfinite(v[i]));
                    if (!isHalf)
                        u[i] = v[i] = std::numeric_limits<double>::quiet_NaN();
                    block.hasHalves[c] |= (uchar)isHalf;
                    seen += isHalf;
                    coordinates[i] += isHalf;
                }
                else
                {
                    seen++;
                    coordinates[i] += 2;
                    if (own[i] != REFRACT_OK)
                        block.status[i] = own[i];
                }
            }
            block.sees[c] = (uchar)(seen == n ? PixelBlock::ALL : seen ? PixelBlock::SOME : PixelBlock::NONE);
        }
        for (int i = 0; i < n; i++)
            if (block.status[i] == REFRACT_OK && coordinates[i] < 3)
                block.status[i] = REFRACT_TOO_FEW_VIEWS;
        weigh(begin, n, block);
    }

    //! Covariances of the pixels; none: all are usual ones.
    void readCovariances(InputArrayOfArrays covariances, InputArrayOfArrays imagePoints)
    {
        std::vector<Mat> all;
        if (!covariances.empty())
            covariances.getMatVector(all);
        if (all.empty())
            return;
        if ((int)all.size() != cameras())
            CV_Error_(Error::StsUnmatchedSizes, ("pixelCovariances has %d elements; cameras has %d", (int)all.size(), cameras()));
        for (int c = 0; c < cameras(); c++)
            covariances_.push_back(readPixelCovariances(all[c], readPoints2(imagePoints.getMat(c), names_[c].c_str()),
                                                        numbered("pixelCovariances", c)));
    }

private:
    //! W of each point, scaled by its best pixel.
    void weigh(int begin, int n, PixelBlock& block) const
    {
        if (covariances_.empty())
            return;
        block.whitening.resize((size_t)BLOCK*cameras());
        block.scale.assign(BLOCK, 1.);
        for (int i = 0; i < n; i++)
        {
            double least = std::numeric_limits<double>::infinity();
            for (int c = 0; c < cameras(); c++)
                if (isSeen(block.pixelOf(c, i)))
                    least = std::min(least, std::min(std::isnan(block.pixel(2*c)[i]) ? least : covarianceOf(c, begin + i).uu,
                                                     std::isnan(block.pixel(2*c + 1)[i]) ? least : covarianceOf(c, begin + i).vv));
            if (std::isfinite(least))
                block.scale[i] = std::sqrt(least);
            for (int c = 0; c < cameras(); c++)
                if (isSeen(block.pixelOf(c, i)))
                    block.whitening[(size_t)c*BLOCK + i] = Whitening(block.pixelOf(c, i), covarianceOf(c, begin + i), block.scale[i]);
        }
    }
    PixelCovariance covarianceOf(int c, int i) const { return covariances_[c].empty() ? PixelCovariance() : covariances_[c][i]; }

    std::vector<PixelCovariances> covariances_;
    std::vector<PointReader> images_;
    std::vector<String> names_;
};

}} // namespace

#endif // OPENCV_REFRACT_IMAGE_READER_HPP
