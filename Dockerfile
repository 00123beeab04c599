# peristat in an image: docker build --tag peristat . makes the Debian package and installs it in a
# slim image without a compiler. docs/installing.md explains how to run it.
FROM debian:12 AS build
COPY . /peristat
RUN apt-get update && /peristat/peristat package

FROM debian:12-slim
COPY --from=build /peristat/build/peristat_*.deb /tmp/
RUN apt-get update \
 && apt-get install --yes --no-install-recommends /tmp/peristat_*.deb \
 && rm -rf /tmp/peristat_*.deb /var/lib/apt/lists/*
# The user of the mounted folder has no home directory here.
ENV MPLCONFIGDIR=/tmp/matplotlib
WORKDIR /work
ENTRYPOINT ["peristat"]
CMD ["help"]
