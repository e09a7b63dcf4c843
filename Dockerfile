# The digest is that of the image for all processors. For a newer image, change tag and digest
# together; `docker buildx imagetools inspect python:TAG` prints the digest of a tag.
FROM python:3.13.15-slim-trixie@sha256:7c61056e61ac89e852de05f3dc6fa51a6dd2181797bceed46aa725dd7cb2cd3b
RUN apt-get update && apt-get install --yes --no-install-recommends make git
WORKDIR /spherical-clearance-joint-study
COPY . .
RUN make setup
CMD ["make", "reproduce"]
