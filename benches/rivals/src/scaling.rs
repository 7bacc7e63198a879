//! The speed-up by threads that share a picture, compared with that by independent pictures.

use crate::ours::ZerosetSide;
use crate::side::Side;
use anyhow::Result;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// Number of pictures per measurement, drawn one after another. With a single picture, the time to
/// wake threads would dominate.
const IN_A_ROW: usize = 32;

/// Pictures drawn at the same time, each with threads of its own.
pub struct Pooled {
    pictures: Vec<(ThreadPool, ZerosetSide)>,
    threads: usize,
}

impl Pooled {
    /// Starts `threads` threads for each picture.
    ///
    /// # Errors
    /// If a thread cannot be started.
    pub fn new(pictures: Vec<ZerosetSide>, threads: usize) -> Result<Self> {
        let pool = |picture| Ok((ThreadPoolBuilder::new().num_threads(threads).build()?, picture));
        Ok(Self { pictures: pictures.into_iter().map(pool).collect::<Result<_>>()?, threads })
    }
}

impl Side for Pooled {
    fn name(&self) -> String {
        let name = self.pictures[0].1.name();
        match (self.pictures.len(), self.threads) {
            (1, 1) => name,
            (1, threads) => format!("{name} on {threads}"),
            (pictures, _) => format!("{name} × {pictures}"),
        }
    }

    fn size(&self) -> usize {
        self.pictures[0].1.size()
    }

    fn pictures(&self) -> usize {
        IN_A_ROW * self.pictures.len()
    }

    fn draw(&mut self) -> Result<()> {
        let draw = |(pool, picture): &mut (ThreadPool, ZerosetSide)| {
            pool.install(|| (0..IN_A_ROW).try_for_each(|_| picture.draw()))
        };
        if let [only] = self.pictures.as_mut_slice() {
            return draw(only);
        }
        std::thread::scope(|scope| {
            let drawn: Vec<_> =
                self.pictures.iter_mut().map(|one| scope.spawn(move || draw(one))).collect();
            drawn.into_iter().try_for_each(|one| one.join().expect("no panic"))
        })
    }

    fn distances(&self) -> Vec<f64> {
        self.pictures[0].1.distances()
    }
}
